#include "pipeline/estimator/plausibility.hpp"

namespace gimbal {
namespace {

constexpr double kEnough_s = 2;
// A shake as fast as arms can do averages below 15 rad/s; a camera in deg/s that is just held
// already shows more in most seconds.
constexpr double kLargestMeanRate_rad_s = 20;
constexpr double kLargestMeanForce_m_s2 = 50;
constexpr double kSmallestMeanForce_m_s2 = 5;
constexpr double kLargestMeanForceInG = 2;
constexpr double kSmallestMeanForceInG = 0.5;

}  // namespace

std::string_view describe(Plausibility plausibility) {
  switch (plausibility) {
    case Plausibility::plausible:
      return "";
    case Plausibility::accel_in_g:
      return "the accelerometer shows about 1 m/s² on average, so it is probably in g; say so "
             "where its "
             "unit is given";
    case Plausibility::accel_too_small:
      return "the accelerometer shows far less than gravity on average; check its unit and scale";
    case Plausibility::accel_too_large:
      return "the accelerometer shows more than 5 g on average; check its unit and scale";
    case Plausibility::gyro_in_degrees:
      return "the gyroscope turns faster than any hand on average, so it is probably in deg/s or "
             "raw "
             "counts; convert it to rad/s";
  }
  return "";
}

void PlausibilityCheck::update(const Eigen::Vector3d& gyro_rad_s,
                               const std::optional<Eigen::Vector3d>& accel_m_s2,
                               double interval_s) {
  gyro_s_ += interval_s;
  gyro_sum_rad_ += gyro_rad_s.norm() * interval_s;
  if (!accel_m_s2) return;
  accel_s_ += interval_s;
  accel_sum_m_s_ += accel_m_s2->norm() * interval_s;
}

Plausibility PlausibilityCheck::verdict() const {
  if (gyro_s_ > kEnough_s && gyro_sum_rad_ > kLargestMeanRate_rad_s * gyro_s_) {
    return Plausibility::gyro_in_degrees;
  }
  if (accel_s_ < kEnough_s) return Plausibility::plausible;
  const double mean = accel_sum_m_s_ / accel_s_;
  if (mean > kLargestMeanForce_m_s2) return Plausibility::accel_too_large;
  if (mean > kSmallestMeanForce_m_s2) return Plausibility::plausible;
  if (mean > kSmallestMeanForceInG && mean < kLargestMeanForceInG) return Plausibility::accel_in_g;
  return Plausibility::accel_too_small;
}

}  // namespace gimbal
