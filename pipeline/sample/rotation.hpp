#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace gimbal {

/// Unit quaternion of a rotation vector (axis times angle, rad): the exponential map.
[[nodiscard]] Eigen::Quaterniond quaternion_exp(const Eigen::Vector3d& rotation_vector);

/// The shorter rotation vector of a unit quaternion, inverse of `quaternion_exp`.
[[nodiscard]] Eigen::Vector3d quaternion_log(const Eigen::Quaterniond& q);

}  // namespace gimbal
