#pragma once

#include <deque>

#include "pipeline/sample/attitude.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

struct AttitudeAnswer {
  Eigen::Quaterniond q_world_imu;
  AttitudeOrigin origin;
};

/// Orientations in order of time, asked for at any instant.
class AttitudeHistory {
 public:
  /// Neighbours further apart than `max_gap` are not trusted: an answer between them says
  /// `predicted`.
  explicit AttitudeHistory(SensorDuration max_gap);

  /// Appends; an attitude that is not later than the last one is refused (false).
  bool append(const Attitude& attitude);

  /// Spherical interpolation (SLERP, thesis 4.3) between the neighbours; the nearest end's
  /// orientation outside. Precondition: not empty.
  [[nodiscard]] AttitudeAnswer at(SensorTime time) const;

  /// Answers from `time` on stay as they are.
  void forget_before(SensorTime time);

  [[nodiscard]] bool empty() const { return attitudes_.empty(); }
  [[nodiscard]] const std::deque<Attitude>& attitudes() const { return attitudes_; }

 private:
  SensorDuration max_gap_;
  std::deque<Attitude> attitudes_;
};

}  // namespace gimbal
