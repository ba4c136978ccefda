#include "pipeline/path/turn.hpp"

#include "pipeline/sample/rotation.hpp"

namespace gimbal {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector3d world_turn(const Quaterniond& q_world_from, const Quaterniond& q_world_to) {
  return quaternion_log(q_world_to * q_world_from.conjugate());
}

Quaterniond turned(const Quaterniond& q_world_from, const Vector3d& world_turn_rad) {
  return quaternion_exp(world_turn_rad) * q_world_from;
}

}  // namespace gimbal
