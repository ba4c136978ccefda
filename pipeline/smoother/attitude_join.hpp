#pragma once

#include <Eigen/Geometry>

#include "pipeline/sample/attitude.hpp"

namespace gimbal {

/// Carries orientations over a break in them, so that a picture does not jump: what comes after the
/// break goes on from the orientation that was held in it. The turn of the world that this takes
/// keeps its part about the vertical, for nothing knows the heading after a break; the rest fades.
class AttitudeJoin {
 public:
  /// From now on the world is turned so that `next` looks as `held` did, a q_world_imu.
  void join(const Eigen::Quaterniond& held, const Attitude& next);

  /// `attitude` in the turned world. Stamps rise.
  [[nodiscard]] Attitude turned(const Attitude& attitude);

  /// The same with its covariance, to which the tilt that has not faded yet adds.
  [[nodiscard]] AttitudeEstimate turned(const AttitudeEstimate& estimate);

 private:
  Eigen::Quaterniond heading_ = Eigen::Quaterniond::Identity();
  Eigen::AngleAxisd tilt_ = Eigen::AngleAxisd::Identity();  ///< about a horizontal axis, after it
  SensorTime last_;
};

}  // namespace gimbal
