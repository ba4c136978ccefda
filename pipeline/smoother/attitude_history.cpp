#include "pipeline/smoother/attitude_history.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "pipeline/estimator/error_state.hpp"

namespace gimbal {
namespace {

constexpr double kRateWalkMemory_s = 0.5;

Eigen::Vector3d mean_rate(const Attitude& from, const Attitude& to) {
  return vector_from_rotation(to.q_world_imu * from.q_world_imu.conjugate()) /
         to_seconds(to.time - from.time);
}

}  // namespace

AttitudeHistory::AttitudeHistory(SensorDuration max_gap) : max_gap_(max_gap) {}

bool AttitudeHistory::append(const AttitudeEstimate& estimate) {
  if (!entries_.empty() && estimate.attitude.time <= newest().attitude.time) return false;
  entries_.push_back(empty() ? Entry{estimate} : follow(entries_.back(), estimate));
  return true;
}

AttitudeHistory::Entry AttitudeHistory::follow(const Entry& last,
                                               const AttitudeEstimate& estimate) {
  Entry entry{estimate};
  entry.interval_s = to_seconds(estimate.attitude.time - last.estimate.attitude.time);
  entry.rate_rad_s = mean_rate(last.estimate.attitude, estimate.attitude);
  if (last.interval_s == 0) return entry;
  // Means over neighbouring intervals differ by a third of what the rate walks in both; a third of
  // the square is an axis' share.
  const double walk =
      (entry.rate_rad_s - last.rate_rad_s).squaredNorm() / (last.interval_s + entry.interval_s);
  const double share =
      last.rate_walk_rad2_s3 ? -std::expm1(-entry.interval_s / kRateWalkMemory_s) : 1;
  const double before = last.rate_walk_rad2_s3.value_or(0);
  entry.rate_walk_rad2_s3 = before + share * (walk - before);
  return entry;
}

void AttitudeHistory::forget_before(SensorTime time) {
  // The last one before the instant is still a neighbour of it.
  while (entries_.size() > 1 && entries_[1].estimate.attitude.time <= time) entries_.pop_front();
}

AttitudeAnswer AttitudeHistory::at(SensorTime time) const {
  const auto time_of = [](const Entry& entry) { return entry.estimate.attitude.time; };
  const auto after = std::ranges::lower_bound(entries_, time, {}, time_of);
  if (after == entries_.end()) return held(entries_.back(), entries_.back(), time);
  const auto& [attitude, covariance_rad2, origin] = after->estimate;
  if (attitude.time == time) return {attitude.q_world_imu, covariance_rad2, origin};
  if (after == entries_.begin()) return held(*after, entries_[size() > 1 ? 1 : 0], time);

  const AttitudeEstimate& before = std::prev(after)->estimate;
  const SensorDuration gap = attitude.time - before.attitude.time;
  const double gap_s = to_seconds(gap);
  const double f = to_seconds(time - before.attitude.time) / gap_s;
  AttitudeAnswer answer;
  answer.q_world_imu = before.attitude.q_world_imu.slerp(f, attitude.q_world_imu);
  // A random walk's integral between two known values, its slope unknown: q T³ f² (1 - f)² / 3.
  const double bend = std::min(
      after->rate_walk_rad2_s3.value_or(0) * gap_s * gap_s * gap_s * f * f * (1 - f) * (1 - f) / 3,
      kUnknownAngle_rad2);
  answer.covariance_rad2 =
      (1 - f) * before.covariance_rad2 + f * covariance_rad2 + bend * Eigen::Matrix3d::Identity();
  answer.origin = gap > max_gap_ ? AttitudeOrigin::predicted
                                 : std::max({before.origin, origin, AttitudeOrigin::interpolated});
  return answer;
}

/// The orientation is held: the turn at the last known rate is missed, and what that walks.
AttitudeAnswer AttitudeHistory::held(const Entry& end, const Entry& motion, SensorTime time) {
  const double away_s = std::abs(to_seconds(time - end.estimate.attitude.time));
  const Eigen::Vector3d missed = away_s * motion.rate_rad_s;
  const double walked = motion.rate_walk_rad2_s3.value_or(0) * away_s * away_s * away_s / 3;
  Eigen::Matrix3d missing = missed * missed.transpose();
  missing.diagonal().array() += walked;
  // Never more than all is unknown.
  missing *= std::min(1.0, kUnknownAngle_rad2 / std::max(missing.trace(), 1e-30));
  return {end.estimate.attitude.q_world_imu, end.estimate.covariance_rad2 + missing,
          AttitudeOrigin::predicted};
}

}  // namespace gimbal
