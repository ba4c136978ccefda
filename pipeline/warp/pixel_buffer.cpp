#include "pipeline/warp/pixel_buffer.hpp"

#include <cstring>

namespace gimbal {

void PixelBuffer::fill(std::size_t bytes, const std::function<void()>& read) {
  glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_.name());
  if (bytes != size_bytes_) {
    glBufferData(GL_PIXEL_PACK_BUFFER, static_cast<GLsizeiptr>(bytes), nullptr, GL_STREAM_READ);
    size_bytes_ = bytes;
  }
  read();
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
}

Result<void> PixelBuffer::copy_to(std::uint8_t* to, std::size_t bytes) {
  glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_.name());
  const void* pixels =
      glMapBufferRange(GL_PIXEL_PACK_BUFFER, 0, static_cast<GLsizeiptr>(bytes), GL_MAP_READ_BIT);
  if (pixels != nullptr) std::memcpy(to, pixels, bytes);
  const bool is_whole = pixels != nullptr && glUnmapBuffer(GL_PIXEL_PACK_BUFFER) == GL_TRUE;
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  if (!is_whole) return failed("gles: the driver does not give what it has read");
  return {};
}

}  // namespace gimbal
