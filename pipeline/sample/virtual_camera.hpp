#pragma once

#include <Eigen/Geometry>

#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// An ideal camera without distortion: pixel = (fx X/Z + cx, fy Y/Z + cy), whole coordinates at
/// pixel centres.
struct PinholeIntrinsics {
  double fx = 1;
  double fy = 1;
  double cx = 0;
  double cy = 0;
};

/// The steady camera whose picture is written for one frame.
struct VirtualCamera {
  FrameStamp stamp;
  Eigen::Quaterniond q_world_camera = Eigen::Quaterniond::Identity();
  PinholeIntrinsics intrinsics;
};

}  // namespace gimbal
