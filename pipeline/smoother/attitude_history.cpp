#include "pipeline/smoother/attitude_history.hpp"

#include <algorithm>
#include <iterator>

namespace gimbal {

AttitudeHistory::AttitudeHistory(SensorDuration max_gap) : max_gap_(max_gap) {}

bool AttitudeHistory::append(const Attitude& attitude) {
  if (!attitudes_.empty() && attitude.time <= attitudes_.back().time) return false;
  attitudes_.push_back(attitude);
  return true;
}

void AttitudeHistory::forget_before(SensorTime time) {
  // The last one before the instant is still a neighbour of it.
  while (attitudes_.size() > 1 && attitudes_[1].time <= time) attitudes_.pop_front();
}

AttitudeAnswer AttitudeHistory::at(SensorTime time) const {
  const auto after = std::ranges::lower_bound(attitudes_, time, {}, &Attitude::time);
  if (after == attitudes_.end()) {
    return {attitudes_.back().q_world_imu, AttitudeOrigin::predicted};
  }
  if (after->time == time) return {after->q_world_imu, AttitudeOrigin::exact};
  if (after == attitudes_.begin()) return {after->q_world_imu, AttitudeOrigin::predicted};

  const auto before = std::prev(after);
  const SensorDuration gap = after->time - before->time;
  const double fraction = to_seconds(time - before->time) / to_seconds(gap);
  return {before->q_world_imu.slerp(fraction, after->q_world_imu),
          gap > max_gap_ ? AttitudeOrigin::predicted : AttitudeOrigin::interpolated};
}

}  // namespace gimbal
