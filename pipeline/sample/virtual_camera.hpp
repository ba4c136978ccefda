#pragma once

#include <Eigen/Geometry>
#include <cstdint>

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

/// What the written picture looks like it was taken with.
enum class OutputLens : std::uint8_t {
  rectilinear,  ///< none: straight lines are straight
  kept,         ///< the real camera's, with its distortion
};

/// The steady camera whose picture is written for one frame. With the lens kept, what an ideal
/// camera has at X/Z and Y/Z lies where the distortion takes it.
struct VirtualCamera {
  FrameStamp stamp;
  Eigen::Quaterniond q_world_camera = Eigen::Quaterniond::Identity();
  PinholeIntrinsics intrinsics;
  OutputLens lens = OutputLens::rectilinear;
  /// How much of the rolling shutter is taken out: less than all of it where the frame is sheared
  /// so much that no view fits it.
  double rectified = 1;
};

}  // namespace gimbal
