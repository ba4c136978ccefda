#pragma once

#include <cstddef>
#include <functional>

#include "pipeline/sample/result.hpp"
#include "pipeline/warp/gl_objects.hpp"

namespace gimbal {

/// Where the GPU puts pixels that are read while it and the processor go on (pixel buffer objects
/// of GLES 3).
class PixelBuffer {
 public:
  PixelBuffer() : buffer_(make_buffer()) {}

  /// What `read` asks for by glReadPixels, of as many bytes, at its beginning.
  void fill(std::size_t bytes, const std::function<void()>& read);

  /// Waits until it is there, then copies as many bytes of it. Fails where the driver gives no
  /// access.
  [[nodiscard]] Result<void> copy_to(std::uint8_t* to, std::size_t bytes);

 private:
  GlBuffer buffer_;
  std::size_t size_bytes_ = 0;
};

}  // namespace gimbal
