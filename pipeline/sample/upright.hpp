#pragma once

#include <Eigen/Geometry>

namespace gimbal {

/// The shortest rotation that takes a direction to world z (up); about x where the direction is
/// straight down and any horizontal axis would do. Length does not matter, but must not be zero.
/// Does what Eigen's FromTwoVectors does, without the SVD that costs every file that calls it
/// several seconds of compilation.
[[nodiscard]] Eigen::Quaterniond turn_upright(const Eigen::Vector3d& direction);

}  // namespace gimbal
