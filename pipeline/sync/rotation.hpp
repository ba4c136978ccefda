#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace gimbal {

/// exp: the rotation by a rotation vector (axis times angle, rad).
[[nodiscard]] inline Eigen::Quaterniond turn_by(const Eigen::Vector3d& vector_rad) {
  const double angle_rad = vector_rad.norm();
  if (angle_rad == 0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, vector_rad / angle_rad));
}

/// log: the rotation vector of the shorter way round, rad.
[[nodiscard]] inline Eigen::Vector3d turn_vector(const Eigen::Quaterniond& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

/// [v]x, so that cross_matrix(v) w = v x w.
[[nodiscard]] inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

}  // namespace gimbal
