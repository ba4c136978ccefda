#include "pipeline/estimator/motor_vibration.hpp"

#include <cmath>

namespace gimbal {
namespace {

constexpr double square(double x) {
  return x * x;
}

double share(double interval_s, double memory_s) {
  return -std::expm1(-interval_s / memory_s);
}

/// From 0 where x is well below 1 to 1 where it is well above.
double rise(double x) {
  return square(x) / (1 + square(x));
}

}  // namespace

void MotorVibration::add(const Eigen::Vector3d& gyro_rad_s,
                         const std::optional<Eigen::Vector3d>& accel_m_s2, double interval_s) {
  const double rate_square = gyro_rad_s.squaredNorm();
  double& rate = rate_mean_square_rad2_s2_ ? *rate_mean_square_rad2_s2_
                                           : rate_mean_square_rad2_s2_.emplace(rate_square);
  rate += share(interval_s, parameters_.rate_memory_s) * (rate_square - rate);

  std::optional<Eigen::Vector3d> change;
  if (accel_m_s2 && last_accel_m_s2_) change = *accel_m_s2 - *last_accel_m_s2_;
  if (change && last_change_m_s2_) {
    // Of what is independent from sample to sample, the second difference has six times the
    // variance.
    const double seen = (*change - *last_change_m_s2_).squaredNorm() / 6;
    accel_mean_square_m2_s4_ +=
        share(interval_s, parameters_.memory_s) * (seen - accel_mean_square_m2_s4_);
  }
  last_accel_m_s2_ = accel_m_s2;
  last_change_m_s2_ = change;
}

double MotorVibration::machine_share() const {
  const double vibration = accel_mean_square_m2_s4_ / square(parameters_.accel_m_s2);
  const double turning =
      rate_mean_square_rad2_s2_.value_or(0) / square(parameters_.hand_rate_rad_s);
  return rise(vibration) * (1 - rise(turning));
}

}  // namespace gimbal
