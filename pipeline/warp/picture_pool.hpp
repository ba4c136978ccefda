#pragma once

#include <functional>
#include <memory>

#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Memory for pictures, used again once all copies of a frame are gone: fresh memory would cost
/// page faults for every frame. Frames may outlive the pool and may be let go on any thread.
class PicturePool {
 public:
  /// Where memory comes from that is not there yet.
  using Allocate = std::function<Nv12Buffer(ImageSize)>;

  explicit PicturePool(Allocate allocate = plain_memory);

  [[nodiscard]] Nv12Buffer take(ImageSize size);

  /// Makes a frame of a picture from `take`; its memory comes back to the pool.
  [[nodiscard]] VideoFrame publish(Nv12Buffer picture, FrameStamp stamp, ColorInfo color);

 private:
  [[nodiscard]] static Nv12Buffer plain_memory(ImageSize size) { return Nv12Buffer(size); }

  struct Shelf;
  Allocate allocate_;
  std::shared_ptr<Shelf> shelf_;
};

}  // namespace gimbal
