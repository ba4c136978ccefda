#pragma once

#include <Eigen/Core>

namespace gimbal {

/// Orientation of a level camera that looks along the world's x: its x axis (right) is the world's
/// -y, its y axis (down) the world's -z.
[[nodiscard]] inline Eigen::Matrix3d level_R_world_camera() {
  Eigen::Matrix3d R_world_camera;
  R_world_camera << 0, 0, 1,  //
      -1, 0, 0,               //
      0, -1, 0;
  return R_world_camera;
}

}  // namespace gimbal
