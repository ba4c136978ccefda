#include "drivers/v4l2/picture_stream.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <string_view>
#include <system_error>
#include <utility>

namespace gimbal {
namespace {

std::string text_of(int error) {
  return std::generic_category().message(error);
}

bool is_gone(int error) {
  return error == ENODEV || error == ESHUTDOWN || error == ENXIO;
}

tl::unexpected<Error> lost(int error) {
  if (is_gone(error)) return failed("the camera has been unplugged");
  return failed("the camera has failed: " + text_of(error));
}

/// What the driver needs queued to go on (control MIN_BUFFERS_FOR_CAPTURE); two where it does not
/// say: one being filled and the next.
std::size_t needed_by(V4l2Device& device) {
  v4l2_control control{V4L2_CID_MIN_BUFFERS_FOR_CAPTURE, 0};
  const int error = device.request(VIDIOC_G_CTRL, &control);
  return error == 0 ? static_cast<std::size_t>(std::clamp(control.value, 2, 16)) : 2;
}

/// Pictures that come by USB are put together by the processor, and the kernel does not bring them
/// from its caches to memory for whoever has imported them before (vb2-vmalloc).
bool is_written_by_processor(V4l2Device& device) {
  v4l2_capability capability{};
  if (device.request(VIDIOC_QUERYCAP, &capability) != 0) return false;
  return std::string_view(reinterpret_cast<const char*>(capability.bus_info)).starts_with("usb-");
}

}  // namespace

struct PictureStream::Descriptor {
  Descriptor(std::uint32_t type, std::size_t memories, std::uint32_t index = 0) {
    buffer.type = type;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    if (V4L2_TYPE_IS_MULTIPLANAR(type)) {
      buffer.m.planes = planes.data();
      buffer.length = static_cast<std::uint32_t>(memories);
    }
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() = default;

  std::array<v4l2_plane, VIDEO_MAX_PLANES> planes{};
  v4l2_buffer buffer{};
};

PictureStream::PictureStream(std::unique_ptr<V4l2Device> device, const PictureFormat& format)
    : device_(std::move(device)), type_(format.type), memory_count_(format.memories.size()) {}

PictureStream::~PictureStream() {
  release();
  for (const auto& buffer : buffers_) {
    for (const Memory& memory : buffer) {
      if (memory.data != nullptr) device_->unmap(memory.data, memory.bytes);
      if (memory.dma_buf >= 0) ::close(memory.dma_buf);
    }
  }
}

Result<std::shared_ptr<PictureStream>> PictureStream::start(std::unique_ptr<V4l2Device> device,
                                                            const PictureFormat& format,
                                                            int buffers, const std::string& users) {
  // NOLINTNEXTLINE(modernize-make-shared): the constructor is private
  std::shared_ptr<PictureStream> stream(new PictureStream(std::move(device), format));
  if (auto done = stream->allocate(buffers, users); !done) return tl::unexpected(done.error());
  if (auto done = stream->begin(); !done) return tl::unexpected(done.error());
  return stream;
}

Result<void> PictureStream::allocate(int buffers, const std::string& users) {
  v4l2_requestbuffers wanted{};
  wanted.count = static_cast<std::uint32_t>(buffers);
  wanted.type = type_;
  wanted.memory = V4L2_MEMORY_MMAP;
  const int error = device_->request(VIDIOC_REQBUFS, &wanted);
  if (error == EBUSY) {
    return failed("busy: in use by " + (users.empty() ? "another program" : users));
  }
  if (error == ENOMEM) {
    return failed(
        fmt::format("no memory for {} buffers; ask for fewer, or give CMA more", buffers));
  }
  if (error != 0) return failed("gives no buffers: " + text_of(error));
  kept_for_device_ = needed_by(*device_);
  is_exported_ = !is_written_by_processor(*device_);
  for (std::uint32_t index = 0; index < wanted.count; ++index) {
    if (auto mapped = map_buffer(index); !mapped) return mapped;
  }
  if (buffers_.empty()) return failed("gives no buffers");
  return {};
}

Result<void> PictureStream::map_buffer(std::uint32_t index) {
  Descriptor described(type_, memory_count_, index);
  if (const int error = device_->request(VIDIOC_QUERYBUF, &described.buffer); error != 0) {
    return failed("does not describe its buffers: " + text_of(error));
  }
  stamp_flags_ = described.buffer.flags;
  buffers_.emplace_back();
  for (std::size_t i = 0; i < memory_count_; ++i) {
    const bool has_planes = V4L2_TYPE_IS_MULTIPLANAR(type_);
    const std::size_t bytes = has_planes ? described.planes[i].length : described.buffer.length;
    const std::int64_t offset =
        has_planes ? described.planes[i].m.mem_offset : described.buffer.m.offset;
    std::uint8_t* data = device_->map(bytes, offset);
    if (data == nullptr) return failed("its buffers cannot be mapped: " + text_of(errno));
    buffers_.back().push_back({data, bytes, export_memory(index, i)});
  }
  return {};
}

int PictureStream::export_memory(std::uint32_t index, std::size_t memory) {
  if (!is_exported_) return -1;
  v4l2_exportbuffer exported{};
  exported.type = type_;
  exported.index = index;
  exported.plane = static_cast<std::uint32_t>(memory);
  exported.flags = O_RDONLY | O_CLOEXEC;
  return device_->request(VIDIOC_EXPBUF, &exported) == 0 ? exported.fd : -1;
}

Result<void> PictureStream::begin() {
  const std::lock_guard lock(mutex_);
  for (std::uint32_t index = 0; index < buffers_.size(); ++index) {
    if (const int error = queue(index); error != 0) return lost(error);
  }
  int type = static_cast<int>(type_);
  const int error = device_->request(VIDIOC_STREAMON, &type);
  if (error == ENOSPC) {
    return failed("there is not enough USB bandwidth; take a smaller size, MJPG, or another port");
  }
  if (error == EPIPE) {
    return failed("its media pipeline is not set up: formats or links do not match (media-ctl)");
  }
  if (error != 0) return failed("does not begin to stream: " + text_of(error));
  is_streaming_ = true;
  return {};
}

int PictureStream::queue(std::uint32_t index) {
  Descriptor described(type_, memory_count_, index);
  const int error = device_->request(VIDIOC_QBUF, &described.buffer);
  if (error == 0) ++queued_;
  return error;
}

Result<std::optional<FilledBuffer>> PictureStream::next(SensorDuration silence_limit) {
  switch (device_->wait(silence_limit)) {
    case V4l2Device::Wakeup::cancelled:
      return std::optional<FilledBuffer>();
    case V4l2Device::Wakeup::timeout:
      return failed(fmt::format("no picture for {:.1f} s", to_seconds(silence_limit)));
    case V4l2Device::Wakeup::picture:
    case V4l2Device::Wakeup::error:
      break;  // the next request says which error
  }
  return dequeue();
}

Result<std::optional<FilledBuffer>> PictureStream::dequeue() {
  const std::lock_guard lock(mutex_);
  if (is_stopped_) return std::optional<FilledBuffer>();
  Descriptor described(type_, memory_count_);
  const v4l2_buffer& buffer = described.buffer;
  if (const int error = device_->request(VIDIOC_DQBUF, &described.buffer); error != 0) {
    return lost(error);
  }
  if (buffer.index >= buffers_.size()) return failed("the driver names a buffer that it has not");
  --queued_;
  FilledBuffer filled;
  filled.index = buffer.index;
  filled.flags = buffer.flags;
  filled.sequence = buffer.sequence;
  filled.stamp = std::chrono::seconds(buffer.timestamp.tv_sec) +
                 std::chrono::microseconds(buffer.timestamp.tv_usec);
  for (std::size_t i = 0; i < memory_count_; ++i) {
    const Memory& memory = buffers_[buffer.index][i];
    const bool has_planes = V4L2_TYPE_IS_MULTIPLANAR(type_);
    const std::size_t end = std::min<std::size_t>(
        memory.bytes, has_planes ? described.planes[i].bytesused : buffer.bytesused);
    const std::size_t begin =
        std::min<std::size_t>(end, has_planes ? described.planes[i].data_offset : 0);
    filled.memories.push_back(
        {memory.data + begin, end - begin, memory.dma_buf, static_cast<std::ptrdiff_t>(begin)});
  }
  return filled;
}

std::shared_ptr<const void> PictureStream::lend(std::uint32_t index) {
  const std::lock_guard lock(mutex_);
  if (queued_ < kept_for_device_) return nullptr;
  return {buffers_[index][0].data,
          [stream = shared_from_this(), index](const void*) { stream->give_back(index); }};
}

void PictureStream::give_back(std::uint32_t index) {
  const std::lock_guard lock(mutex_);
  // A device that is gone does not take it; the next wait says so.
  if (is_streaming_) static_cast<void>(queue(index));
}

void PictureStream::stop() {
  device_->cancel();
  release();
}

bool PictureStream::has_stopped() const {
  const std::lock_guard lock(mutex_);
  return is_stopped_;
}

/// Other programs, and the next start, can have the device from here on, though frames may still
/// hold its memory: the kernel lets go of buffers that are mapped (V4L2_BUF_CAP_SUPPORTS_ORPHANED_
/// BUFS, since 4.20).
void PictureStream::release() {
  const std::lock_guard lock(mutex_);
  if (std::exchange(is_stopped_, true)) return;
  is_streaming_ = false;
  int type = static_cast<int>(type_);
  static_cast<void>(device_->request(VIDIOC_STREAMOFF, &type));
  v4l2_requestbuffers none{};
  none.type = type_;
  none.memory = V4L2_MEMORY_MMAP;
  static_cast<void>(device_->request(VIDIOC_REQBUFS, &none));
}

}  // namespace gimbal
