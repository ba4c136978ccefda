#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// How the planes of a picture lie in one dma-buf.
struct PictureLayout {
  ImageSize size;
  std::ptrdiff_t luma_stride_bytes = 0;
  std::ptrdiff_t chroma_stride_bytes = 0;
  std::ptrdiff_t chroma_offset_bytes = 0;

  friend bool operator==(const PictureLayout&, const PictureLayout&) = default;
};

/// One that every GPU takes: rows begin at multiples of 256 bytes, and the chroma where the luma
/// ends, as encoders want it.
[[nodiscard]] PictureLayout padded_layout(ImageSize size);

/// Memory that the processor, the GPU and other devices share, as dma-bufs (kernel:
/// userspace-api/dma-buf-alloc-exchange.rst).
class DmaBufHeap {
 public:
  /// Opens what hands out such memory here: heaps of contiguous memory, which the display and the
  /// encoders of small boards need; else the system's heap, or udmabuf. The error says why each
  /// cannot be had.
  [[nodiscard]] static Result<DmaBufHeap> open();

  /// Mapped, not initialised; from the first heap that has as much.
  [[nodiscard]] Result<Nv12Buffer> allocate(const PictureLayout& layout) const;

 private:
  struct Heap;
  explicit DmaBufHeap(std::vector<std::shared_ptr<const Heap>> heaps);

  std::vector<std::shared_ptr<const Heap>> heaps_;
};

// Around what the processor does with a picture in a dma-buf, so that it sees what devices have
// written, and they what it has (linux/dma-buf.h). Without effect on pictures in other memory.
void begin_reading(const Nv12Buffer& picture);
void end_reading(const Nv12Buffer& picture);
void begin_writing(const Nv12Buffer& picture);
void end_writing(const Nv12Buffer& picture);

}  // namespace gimbal
