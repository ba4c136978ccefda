#include "pipeline/gstreamer/gst_frames.hpp"

#include <gst/allocators/gstdmabuf.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pipeline/gstreamer/gst_runtime.hpp"

namespace gimbal {
namespace {

constexpr ImageSize kSize{40, 20};
constexpr std::ptrdiff_t kStride_bytes = 64;
constexpr std::ptrdiff_t kChromaOffset_bytes = kStride_bytes * 24;  // rows between the planes
constexpr std::size_t kBytes = 4096;

/// Stands for a dma-buf, which only some kernels hand out: GStreamer looks at neither's inside.
class SharedMemory {
 public:
  SharedMemory() : fd_(::memfd_create("picture", MFD_CLOEXEC)) {
    EXPECT_EQ(::ftruncate(fd_, kBytes), 0);
    void* const mapped = ::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, 0);
    data_ = static_cast<std::uint8_t*>(mapped);
    for (std::size_t i = 0; i < kBytes; ++i) data_[i] = static_cast<std::uint8_t>(i * 7);
  }
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;
  ~SharedMemory() {
    ::munmap(data_, kBytes);
    ::close(fd_);
  }

  [[nodiscard]] static VideoFrame frame(const std::shared_ptr<SharedMemory>& memory) {
    VideoFrame frame;
    frame.size = kSize;
    frame.planes = {
        {{memory->data_, kStride_bytes}, {memory->data_ + kChromaOffset_bytes, kStride_bytes}}};
    frame.dma_buf = {{{memory->fd_, 0}, {memory->fd_, kChromaOffset_bytes}}};
    frame.storage = memory;
    return frame;
  }

 private:
  int fd_;
  std::uint8_t* data_;
};

void expect_plane_shown(const GstVideoFrame& mapped, const VideoFrame& frame, guint plane) {
  EXPECT_EQ(GST_VIDEO_FRAME_PLANE_STRIDE(&mapped, plane), kStride_bytes);
  const auto* seen = static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&mapped, plane));
  const int rows = plane == 0 ? kSize.height : kSize.height / 2;
  for (int y = 0; y < rows; ++y) {
    const std::uint8_t* const row = frame.planes[plane].data + y * kStride_bytes;
    EXPECT_TRUE(std::equal(row, row + kSize.width, seen + y * kStride_bytes)) << y;
  }
}

TEST(WrapFrame, WhatLiesInADmaBufGoesAsOne) {
  ASSERT_TRUE(init_gstreamer());
  const auto memory = std::make_shared<SharedMemory>();
  const VideoFrame frame = SharedMemory::frame(memory);
  GstBufferPtr buffer = wrap_frame(frame);
  ASSERT_EQ(gst_buffer_n_memory(buffer.get()), 1U);
  EXPECT_TRUE(gst_is_dmabuf_memory(gst_buffer_peek_memory(buffer.get(), 0)));
  EXPECT_EQ(memory.use_count(), 3);  // the test's, the frame's, the buffer's

  const GstCapsPtr caps = nv12_caps(kSize, 30, {});
  GstVideoInfo info;
  ASSERT_TRUE(gst_video_info_from_caps(&info, caps.get()));
  GstVideoFrame mapped;
  ASSERT_TRUE(gst_video_frame_map(&mapped, &info, buffer.get(), GST_MAP_READ));
  expect_plane_shown(mapped, frame, 0);
  expect_plane_shown(mapped, frame, 1);
  gst_video_frame_unmap(&mapped);

  buffer.reset();
  EXPECT_EQ(memory.use_count(), 2);
}

TEST(WrapFrame, TwoDmaBufsGoAsPlainMemory) {
  ASSERT_TRUE(init_gstreamer());
  const auto memory = std::make_shared<SharedMemory>();
  const auto other = std::make_shared<SharedMemory>();
  VideoFrame frame = SharedMemory::frame(memory);
  (*frame.dma_buf)[1].fd = (*SharedMemory::frame(other).dma_buf)[1].fd;
  const GstBufferPtr buffer = wrap_frame(frame);
  for (guint i = 0; i < gst_buffer_n_memory(buffer.get()); ++i) {
    EXPECT_FALSE(gst_is_dmabuf_memory(gst_buffer_peek_memory(buffer.get(), i)));
  }
}

}  // namespace
}  // namespace gimbal
