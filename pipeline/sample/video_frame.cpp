#include "pipeline/sample/video_frame.hpp"

#include <new>
#include <utility>

namespace gimbal {
namespace {

constexpr std::size_t kAlignmentBytes =
    64;  // a cache line, and what SIMD loads and GPU uploads like

constexpr std::ptrdiff_t align_up(std::ptrdiff_t bytes) {
  constexpr auto alignment = static_cast<std::ptrdiff_t>(kAlignmentBytes);
  return (bytes + alignment - 1) / alignment * alignment;
}

std::shared_ptr<std::uint8_t[]> allocate(std::size_t bytes) {
  auto* memory =
      static_cast<std::uint8_t*>(::operator new[](bytes, std::align_val_t{kAlignmentBytes}));
  return {memory,
          [](std::uint8_t* data) { ::operator delete[](data, std::align_val_t{kAlignmentBytes}); }};
}

}  // namespace

std::string_view name_of(NativeFormat format) {
  switch (format) {
    case NativeFormat::i420:
      return "I420";
    case NativeFormat::yuyv:
      return "YUYV";
    case NativeFormat::uyvy:
      return "UYVY";
    case NativeFormat::rgb:
      return "RGB";
    case NativeFormat::bgr:
      break;
  }
  return "BGR";
}

Nv12Buffer::Nv12Buffer(ImageSize size) : size_(size) {
  const ImageSize chroma = chroma_size(size);
  const std::ptrdiff_t luma_stride = align_up(size.width);
  const std::ptrdiff_t chroma_stride = align_up(std::ptrdiff_t{2} * chroma.width);
  const std::ptrdiff_t luma_bytes = luma_stride * size.height;
  const auto memory =
      allocate(static_cast<std::size_t>(luma_bytes + chroma_stride * chroma.height));
  planes_ = {{{memory.get(), luma_stride}, {memory.get() + luma_bytes, chroma_stride}}};
  storage_ = memory;
}

Nv12Buffer::Nv12Buffer(ImageSize size, const std::array<MutablePlane, 2>& planes,
                       std::shared_ptr<void> storage, const std::array<DmaBufPlane, 2>& dma_buf)
    : size_(size), planes_(planes), storage_(std::move(storage)), dma_buf_(dma_buf) {}

VideoFrame Nv12Buffer::publish(FrameStamp stamp, ColorInfo color) && {
  VideoFrame frame;
  frame.stamp = stamp;
  frame.size = size_;
  frame.color = std::move(color);
  frame.planes = {
      {{planes_[0].data, planes_[0].stride_bytes}, {planes_[1].data, planes_[1].stride_bytes}}};
  frame.storage = std::move(storage_);
  frame.dma_buf = dma_buf_;
  return frame;
}

}  // namespace gimbal
