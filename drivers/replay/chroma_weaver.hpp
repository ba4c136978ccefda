#pragma once

#include <cstdint>
#include <memory>

#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Brings the two chroma planes of I420, which most decoders write, to the one of NV12: all of a
/// picture that has to move. The memory is used again once all copies of a frame are gone, since
/// fresh memory would cost page faults for every frame. Frames may outlive the weaver and may be
/// let go on any thread.
class ChromaWeaver {
 public:
  ChromaWeaver();

  /// Of a picture of this size in luma: its planes U and V as plane 1 of `frame`, whose storage
  /// then keeps the new memory too.
  void weave(ConstPlane u, ConstPlane v, VideoFrame& frame);

  /// Of all pictures so far.
  [[nodiscard]] std::int64_t bytes_written() const { return bytes_written_; }

 private:
  struct Shelf;
  std::shared_ptr<Shelf> shelf_;
  std::int64_t bytes_written_ = 0;
};

}  // namespace gimbal
