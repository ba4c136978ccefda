#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// What is true of a moving camera at an instant. Camera axes x right, y down, z forward; world z
/// up.
struct MotionState {
  Eigen::Quaterniond q_world_camera;
  Eigen::Vector3d rate_rad_s;              ///< angular velocity in camera axes
  Eigen::Vector3d rate_derivative_rad_s2;  ///< its derivative in camera axes
  Eigen::Vector3d acceleration_m_s2;  ///< of the camera's centre, in world axes, without gravity
};

/// Control points of a motion, evenly spaced in time, as many of the one as of the other.
struct MotionKnots {
  SensorTime first;
  SensorDuration spacing{};
  std::vector<Eigen::Quaterniond> q_world_camera;
  std::vector<Eigen::Vector3d> acceleration_m_s2;
};

/// A camera's motion, known exactly at every instant: a cumulative cubic B-spline on SO(3), twice
/// continuously differentiable, whose angular velocity has a closed form (Sommer et al., "Efficient
/// Derivative Computation for Cumulative B-Splines on Lie Groups", CVPR 2020). The truth that a
/// picture row and a gyro sample share is therefore one and the same function. Like every B-spline
/// it passes close to its control points, not through them; a constant rate is kept exactly.
class Motion {
 public:
  /// Preconditions: at least four knots, spacing above zero.
  explicit Motion(MotionKnots knots);

  /// Outside of [begin, end] the camera stands still at the nearer end's orientation.
  [[nodiscard]] MotionState at(SensorTime time) const;

  /// The same motion, later.
  [[nodiscard]] Motion delayed(SensorDuration delay) const;

  [[nodiscard]] SensorTime begin() const;
  [[nodiscard]] SensorTime end() const;

 private:
  MotionKnots knots_;
  std::vector<Eigen::Vector3d> steps_;  ///< rotation vector from each knot to the next
};

}  // namespace gimbal
