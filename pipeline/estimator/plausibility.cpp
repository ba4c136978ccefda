#include "pipeline/estimator/plausibility.hpp"

#include <algorithm>

namespace gimbal {
namespace {

constexpr double kPoll_s = 2;
constexpr double kLongestVote_s = 0.1;  // a hole says nothing

// A shake as fast as arms can do stays below 15 rad/s; a camera in deg/s that is just held
// already shows more most of the time.
constexpr double kLargestRate_rad_s = 20;
constexpr double kLargestForce_m_s2 = 50;
constexpr double kSmallestForce_m_s2 = 5;
constexpr double kLargestForceInG = 2;
constexpr double kSmallestForceInG = 0.5;

bool any_is_stuck(const AxisLosses& losses) {
  return std::ranges::find(losses, AxisLoss::stuck) != losses.end();
}

Plausibility look_of_gyro(const Eigen::Vector3d& rate_rad_s, const AxisLosses& losses) {
  if (rate_rad_s.norm() > kLargestRate_rad_s) return Plausibility::gyro_in_degrees;
  return any_is_stuck(losses) ? Plausibility::gyro_stuck : Plausibility::plausible;
}

Plausibility look_of_accel(const Eigen::Vector3d& accel_m_s2, const AxisLosses& losses) {
  if (any_is_stuck(losses)) return Plausibility::accel_stuck;
  const double force = accel_m_s2.norm();
  if (force > kLargestForce_m_s2) return Plausibility::accel_too_large;
  if (force > kSmallestForce_m_s2) return Plausibility::plausible;
  if (force > kSmallestForceInG && force < kLargestForceInG) return Plausibility::accel_in_g;
  return Plausibility::accel_too_small;
}

}  // namespace

std::string_view describe(Plausibility plausibility) {
  switch (plausibility) {
    case Plausibility::plausible:
      return "";
    case Plausibility::gyro_in_degrees:
      return "the gyroscope turns faster than any hand most of the time, so it is probably in "
             "deg/s or raw counts; convert it to rad/s";
    case Plausibility::gyro_stuck:
      return "an axis of the gyroscope repeats its value while the others move, so it is stuck and "
             "its turns are missing; check the sensor";
    case Plausibility::accel_in_g:
      return "the accelerometer shows about 1 m/s² most of the time, so it is probably in g; say "
             "so where its unit is given";
    case Plausibility::accel_too_small:
      return "the accelerometer shows far less than gravity most of the time; check its unit and "
             "scale";
    case Plausibility::accel_too_large:
      return "the accelerometer shows more than 5 g most of the time; check its unit and scale";
    case Plausibility::accel_stuck:
      return "an axis of the accelerometer repeats its value while the others move, so it is stuck "
             "and the accelerometer is not used meanwhile; check the sensor";
  }
  return "";
}

void PlausibilityCheck::update(const ImuSample& sample, const AxisLosses& gyro,
                               const AxisLosses& accel) {
  const double interval_s =
      last_ ? std::clamp(to_seconds(sample.time - *last_), 0.0, kLongestVote_s) : 0;
  last_ = sample.time;
  if (sample.gyro_rad_s.allFinite()) vote(gyro_, look_of_gyro(sample.gyro_rad_s, gyro), interval_s);
  if (sample.accel_m_s2 && sample.accel_m_s2->allFinite()) {
    vote(accel_, look_of_accel(*sample.accel_m_s2, accel), interval_s);
  }
}

void PlausibilityCheck::vote(Poll& poll, Plausibility looks, double interval_s) {
  double& votes_s = poll.votes_s[static_cast<std::size_t>(looks)];
  votes_s += interval_s;
  poll.total_s += interval_s;
  if (poll.total_s < kPoll_s) return;
  const auto most = std::ranges::max_element(poll.votes_s);
  const bool decides = *most > poll.total_s / 2;
  if (decides && verdict_ == Plausibility::plausible) {
    verdict_ = static_cast<Plausibility>(most - poll.votes_s.begin());
  }
  poll = {};
}

}  // namespace gimbal
