#include "pipeline/sample/upright.hpp"

#include <cmath>

namespace gimbal {

Eigen::Quaterniond turn_upright(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d axis(direction.y(), -direction.x(), 0);  // direction x z
  const double horizontal = axis.norm();
  const Eigen::Vector3d unit_axis =
      horizontal > 0 ? Eigen::Vector3d(axis / horizontal) : Eigen::Vector3d::UnitX();
  return Eigen::Quaterniond(Eigen::AngleAxisd(std::atan2(horizontal, direction.z()), unit_axis));
}

}  // namespace gimbal
