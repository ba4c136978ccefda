#include "pipeline/path/turn.hpp"

#include <cmath>

namespace gimbal {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector3d world_turn(const Quaterniond& q_world_from, const Quaterniond& q_world_to) {
  const Quaterniond q = q_world_to * q_world_from.conjugate();
  const double sine = q.vec().norm();
  constexpr double kTiny = 1e-9;
  const double scale = sine < kTiny ? 2 / q.w() : 2 * std::atan2(sine, std::abs(q.w())) / sine;
  return (q.w() < 0 && sine >= kTiny ? -scale : scale) * q.vec();
}

Quaterniond turned(const Quaterniond& q_world_from, const Vector3d& world_turn_rad) {
  const double angle = world_turn_rad.norm();
  if (angle == 0) return q_world_from;
  return Eigen::AngleAxisd(angle, world_turn_rad / angle) * q_world_from;
}

}  // namespace gimbal
