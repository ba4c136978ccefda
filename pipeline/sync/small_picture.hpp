#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/sync/offset_tracker.hpp"

namespace gimbal {

/// A frame's luma, of which whole blocks have been averaged.
struct SmallPicture {
  FrameStamp stamp;
  ImageSize size;
  int block_px = 1;  ///< width and height of a block
  std::vector<std::uint8_t> luma;
};

/// The blocks that leave a picture of some 640 pixels' width.
[[nodiscard]] constexpr int block_for(ImageSize size) {
  constexpr int kWidth_px = 640;
  return std::max(1, (size.width + kWidth_px / 2) / kWidth_px);
}

/// A copy: the frame may go. Fails where OpenCV does, as for a frame without a whole block.
[[nodiscard]] Result<SmallPicture> small_picture(const VideoFrame& frame, int block_px);

/// Follows so many corners at most from the first picture through all; in pixels of the whole
/// frame. On the caller's thread alone, once `keep_to_own_thread` has been called. Fails where
/// OpenCV does, and if the pictures are not of one size.
[[nodiscard]] Result<FollowedBurst> follow_burst(std::span<const SmallPicture> pictures,
                                                 int corners);

/// From now on OpenCV uses no other threads than those that call it, in the whole program.
void keep_to_own_thread();

}  // namespace gimbal
