#pragma once

#include <span>

#include "pipeline/sync/small_picture.hpp"

namespace gimbal {

/// What follows corners, as a table of functions: it may lie in a module that is loaded only where
/// it is wanted, since OpenCV's libraries are many.
struct CornerFollower {
  Result<SmallPicture> (*small_picture)(const VideoFrame& frame, int block_px);
  Result<FollowedBurst> (*follow_burst)(std::span<const SmallPicture> pictures, int corners);
};

}  // namespace gimbal

/// The one of this program or module. From then on OpenCV uses no other threads than those that
/// call it.
extern "C" const gimbal::CornerFollower* gimbald_corner_follower();
