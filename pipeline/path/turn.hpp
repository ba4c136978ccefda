#pragma once

#include <Eigen/Geometry>

namespace gimbal {

/// The rotation vector about world axes, at most half a turn, that takes one orientation to
/// another.
[[nodiscard]] Eigen::Vector3d world_turn(const Eigen::Quaterniond& q_world_from,
                                         const Eigen::Quaterniond& q_world_to);

/// Where that rotation vector leads.
[[nodiscard]] Eigen::Quaterniond turned(const Eigen::Quaterniond& q_world_from,
                                        const Eigen::Vector3d& world_turn_rad);

}  // namespace gimbal
