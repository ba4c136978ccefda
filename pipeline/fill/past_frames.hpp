#pragma once

#include <cstddef>
#include <deque>

#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// More frames to come than that are not looked at.
constexpr std::size_t kMostFramesAhead = 30;

/// Pictures that have been drawn and are kept for those to come: the last 8 frames, every second of
/// the 8 before them, and every fourth of the 16 before these; 16 pictures at most.
class PastFrames {
 public:
  void push(const VideoFrame& frame);

  /// Oldest first.
  [[nodiscard]] const std::deque<VideoFrame>& frames() const { return frames_; }

  void clear() { frames_.clear(); }

 private:
  std::deque<VideoFrame> frames_;
};

}  // namespace gimbal
