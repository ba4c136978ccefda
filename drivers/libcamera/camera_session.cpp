#include "drivers/libcamera/camera_session.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <linux/dma-buf.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <system_error>
#include <utility>

#include "drivers/libcamera/control_values.hpp"

namespace gimbal {
namespace {

/// One that is being filled, and the next.
constexpr std::size_t kKeptForCamera = 2;

std::string text_of(int error) {
  return std::generic_category().message(std::abs(error));
}

/// Makes what a device has written visible to the processor, and ends that (linux/dma-buf.h). Where
/// the memory is no dma-buf there is nothing to do.
void sync(const libcamera::SharedFD& fd, std::uint64_t flags) {
  dma_buf_sync access{flags | DMA_BUF_SYNC_READ};
  static_cast<void>(::ioctl(fd.get(), DMA_BUF_IOCTL_SYNC, &access));
}

std::string list_of(const libcamera::StreamFormats& formats) {
  std::vector<std::string> names;
  for (const libcamera::PixelFormat& format : formats.pixelformats()) {
    names.push_back(format.toString());
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

Result<KnownLibcameraFormat> choose_format(const libcamera::StreamFormats& offered,
                                           const std::string& wish) {
  const auto formats = offered.pixelformats();
  for (const KnownLibcameraFormat& known : known_libcamera_formats()) {
    const bool is_wanted = wish == "auto" || wish == known.name;
    if (is_wanted && std::ranges::find(formats, known.format) != formats.end()) return known;
  }
  return bad_input(fmt::format("does not offer pixel format {}; it offers {}",
                               wish == "auto" ? "NV12, YUV420, RGB888 or BGR888" : wish,
                               list_of(offered)));
}

std::optional<SensorDuration> microseconds(const std::optional<std::int64_t>& count) {
  if (!count || *count <= 0) return std::nullopt;
  return std::chrono::microseconds(*count);
}

}  // namespace

CameraSession::CameraSession(std::shared_ptr<libcamera::CameraManager> manager,
                             std::shared_ptr<libcamera::Camera> camera)
    : manager_(std::move(manager)), camera_(std::move(camera)) {}

CameraSession::~CameraSession() {
  tear_down();
  for (const Buffer& buffer : buffers_) {
    for (const Mapping& mapping : buffer.mappings) ::munmap(mapping.memory, mapping.bytes);
  }
}

Result<std::shared_ptr<CameraSession>> CameraSession::start(
    std::shared_ptr<libcamera::CameraManager> manager, std::shared_ptr<libcamera::Camera> camera,
    const LibcameraSettings& settings) {
  // NOLINTNEXTLINE(modernize-make-shared): the constructor is private
  std::shared_ptr<CameraSession> session(new CameraSession(std::move(manager), std::move(camera)));
  if (auto done = session->configure(settings); !done) return tl::unexpected(done.error());
  if (auto done = session->map_buffers(); !done) return tl::unexpected(done.error());
  if (auto done = session->begin(settings); !done) return tl::unexpected(done.error());
  return session;
}

Result<void> CameraSession::configure(const LibcameraSettings& settings) {
  if (const int error = camera_->acquire(); error != 0) {
    return failed(error == -EBUSY ? "busy: another program has it"
                                  : "cannot be acquired: " + text_of(error));
  }
  is_acquired_ = true;
  configuration_ = camera_->generateConfiguration({libcamera::StreamRole::VideoRecording});
  if (!configuration_ || configuration_->empty()) return bad_input("delivers no video");
  libcamera::StreamConfiguration& stream = configuration_->at(0);
  const auto format = choose_format(stream.formats(), settings.pixel_format);
  if (!format) return tl::unexpected(format.error());
  stream.pixelFormat = format->format;
  if (settings.size) {
    stream.size = {static_cast<unsigned>(settings.size->width),
                   static_cast<unsigned>(settings.size->height)};
  }
  const libcamera::Size wanted = stream.size;
  const auto status = configuration_->validate();
  if (status == libcamera::CameraConfiguration::Invalid || stream.pixelFormat != format->format ||
      (settings.size && stream.size != wanted)) {
    return bad_input(fmt::format("does not offer {} {}; the nearest is {} {}", format->name,
                                 wanted.toString(), stream.pixelFormat.toString(),
                                 stream.size.toString()));
  }
  if (const int error = camera_->configure(configuration_.get()); error != 0) {
    return failed("cannot be configured: " + text_of(error));
  }
  stream_ = stream.stream();
  pictures_ = {{static_cast<int>(stream.size.width), static_cast<int>(stream.size.height)},
               format->layout,
               static_cast<std::ptrdiff_t>(stream.stride),
               color_of(format->layout, stream.colorSpace)};
  return {};
}

Result<void> CameraSession::map_buffers() {
  allocator_ = std::make_unique<libcamera::FrameBufferAllocator>(camera_);
  if (const int count = allocator_->allocate(stream_); count <= 0) {
    return failed("gives no buffers: " + text_of(count));
  }
  for (const auto& buffer : allocator_->buffers(stream_)) {
    if (auto mapped = map_buffer(*buffer); !mapped) return mapped;
  }
  return {};
}

/// Planes may share a dma-buf, which is mapped once, or one plane may hold them all.
Result<void> CameraSession::map_buffer(const libcamera::FrameBuffer& source) {
  const std::vector<PlaneExtent> extents = extents_of(pictures_);
  const auto& described = source.planes();
  const bool is_one = described.size() < extents.size();
  if (described.empty()) return failed("its buffers have no planes");
  std::size_t begin = described[0].offset;
  Buffer& buffer = buffers_.emplace_back();
  for (std::size_t i = 0; i < extents.size(); ++i) {
    const auto& from = described[is_one ? 0 : i];
    const std::size_t offset = is_one ? begin : from.offset;
    const std::size_t room =
        is_one ? described[0].offset + described[0].length : std::size_t{from.offset} + from.length;
    if (offset + extents[i].bytes > room) return failed("its buffers are too small");
    const auto mapping = mapping_of(buffer, from.fd, room);
    if (!mapping) return tl::unexpected(mapping.error());
    const auto* memory = static_cast<const std::uint8_t*>((*mapping)->memory);
    buffer.planes.push_back({{memory + offset, extents[i].stride_bytes},
                             from.fd.get(),
                             static_cast<std::ptrdiff_t>(offset)});
    const int rows = i == 0 ? pictures_.size.height : chroma_size(pictures_.size).height;
    begin += static_cast<std::size_t>(extents[i].stride_bytes * rows);
  }
  return {};
}

Result<CameraSession::Mapping*> CameraSession::mapping_of(Buffer& buffer,
                                                          const libcamera::SharedFD& fd,
                                                          std::size_t bytes) {
  for (Mapping& mapping : buffer.mappings) {
    if (mapping.fd == fd && mapping.bytes >= bytes) return &mapping;
  }
  // To its end, so that planes which follow in it find it mapped.
  const off_t end = ::lseek(fd.get(), 0, SEEK_END);
  const std::size_t all = end > 0 ? std::max(bytes, static_cast<std::size_t>(end)) : bytes;
  void* memory = ::mmap(nullptr, all, PROT_READ, MAP_SHARED, fd.get(), 0);
  if (memory == MAP_FAILED) return failed("its buffers cannot be mapped: " + text_of(errno));
  // Planes point to the memory, not to this entry, which may move.
  buffer.mappings.push_back({memory, all, fd});
  return &buffer.mappings.back();
}

Result<void> CameraSession::begin(const LibcameraSettings& settings) {
  auto controls = control_list(camera_->controls(), settings.controls);
  if (!controls) return tl::unexpected(controls.error());
  if (settings.fps) set_rate(*controls, *settings.fps);
  camera_->requestCompleted.connect(this, &CameraSession::completed);
  camera_->disconnected.connect(this, &CameraSession::disconnected);
  const std::lock_guard lock(camera_mutex_);
  if (const int error = camera_->start(&*controls); error != 0) {
    return failed("does not start: " + text_of(error));
  }
  is_running_ = true;
  const auto& buffers = allocator_->buffers(stream_);
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    auto request = camera_->createRequest(i);
    if (!request || request->addBuffer(stream_, buffers[i].get()) != 0) {
      return failed("makes no requests");
    }
    // Not every pipeline takes controls when it starts.
    request->controls().merge(*controls);
    requests_.push_back(std::move(request));
  }
  {
    const std::lock_guard counting(mutex_);
    queued_ = requests_.size();  // before any can complete
  }
  for (const auto& request : requests_) {
    if (const int error = camera_->queueRequest(request.get()); error != 0) {
      return failed("takes no requests: " + text_of(error));
    }
  }
  return {};
}

void CameraSession::set_rate(libcamera::ControlList& controls, double fps) {
  const auto& limits = libcamera::controls::FrameDurationLimits;
  const auto& known = camera_->controls();
  if (known.find(limits.id()) == known.end()) {
    warnings_.push_back(fmt::format("its rate cannot be set to {:.4g} frames a second", fps));
    return;
  }
  if (controls.contains(limits.id())) return;  // said already, and more exactly
  const auto duration_us = static_cast<std::int64_t>(std::llround(1e6 / fps));
  const std::array<std::int64_t, 2> both = {duration_us, duration_us};
  controls.set(limits.id(), libcamera::ControlValue(libcamera::Span<const std::int64_t, 2>(both)));
}

/// On libcamera's thread. Requests are not touched again until they go back.
void CameraSession::completed(libcamera::Request* request) {
  if (request->status() == libcamera::Request::RequestCancelled) return;  // it is being stopped
  CapturedPicture picture;
  picture.buffer = static_cast<std::size_t>(request->cookie());
  const libcamera::FrameMetadata& buffer = request->findBuffer(stream_)->metadata();
  picture.sequence = buffer.sequence;
  picture.is_damaged = buffer.status != libcamera::FrameMetadata::FrameSuccess;
  const libcamera::ControlList& metadata = request->metadata();
  if (const auto stamp = metadata.get(libcamera::controls::SensorTimestamp)) {
    picture.stamp = SensorDuration(*stamp);
  } else if (buffer.timestamp != 0) {
    picture.stamp = SensorDuration(static_cast<std::int64_t>(buffer.timestamp));
  }
  if (const auto exposure = metadata.get(libcamera::controls::ExposureTime)) {
    picture.exposure = microseconds(std::int64_t{*exposure});
  }
  picture.frame_duration = microseconds(metadata.get(libcamera::controls::FrameDuration));
  const std::lock_guard lock(mutex_);
  captured_.push_back(picture);
  --queued_;
  changed_.notify_all();
}

void CameraSession::disconnected() {
  const std::lock_guard lock(mutex_);
  is_disconnected_ = true;
  changed_.notify_all();
}

Result<std::optional<CapturedPicture>> CameraSession::next(SensorDuration silence_limit) {
  std::unique_lock lock(mutex_);
  const auto deadline = std::chrono::steady_clock::now() + silence_limit;
  const bool is_over = changed_.wait_until(
      lock, deadline, [this] { return is_stopped_ || is_disconnected_ || !captured_.empty(); });
  if (is_stopped_) return std::optional<CapturedPicture>();
  if (is_disconnected_) return failed("the camera has been disconnected");
  if (!is_over) return failed(fmt::format("no picture for {:.1f} s", to_seconds(silence_limit)));
  const CapturedPicture picture = captured_.front();
  captured_.pop_front();
  for (const Mapping& mapping : buffers_[picture.buffer].mappings) {
    sync(mapping.fd, DMA_BUF_SYNC_START);
  }
  return picture;
}

std::shared_ptr<const void> CameraSession::lend(std::size_t buffer) {
  {
    const std::lock_guard lock(mutex_);
    // What is captured already comes back as soon as it has been read.
    if (queued_ + captured_.size() < kKeptForCamera) return nullptr;
  }
  return {buffers_[buffer].mappings[0].memory,
          [session = shared_from_this(), buffer](const void*) { session->give_back(buffer); }};
}

void CameraSession::give_back(std::size_t buffer) {
  for (const Mapping& mapping : buffers_[buffer].mappings) sync(mapping.fd, DMA_BUF_SYNC_END);
  const std::lock_guard lock(camera_mutex_);
  if (!is_running_) return;
  {
    const std::lock_guard counting(mutex_);
    ++queued_;  // before it can complete
  }
  requests_[buffer]->reuse(libcamera::Request::ReuseBuffers);
  if (camera_->queueRequest(requests_[buffer].get()) != 0) {
    const std::lock_guard counting(mutex_);
    --queued_;  // a camera that is gone takes none
  }
}

void CameraSession::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
    changed_.notify_all();
  }
  tear_down();
}

bool CameraSession::has_stopped() const {
  const std::lock_guard lock(mutex_);
  return is_stopped_;
}

/// Leaves the memory mapped for the frames that hold it, and nothing of libcamera.
void CameraSession::tear_down() {
  const std::lock_guard lock(camera_mutex_);
  if (!camera_) return;
  if (std::exchange(is_running_, false)) static_cast<void>(camera_->stop());
  camera_->requestCompleted.disconnect(this);
  camera_->disconnected.disconnect(this);
  requests_.clear();
  allocator_.reset();
  configuration_.reset();
  if (std::exchange(is_acquired_, false)) static_cast<void>(camera_->release());
  camera_.reset();
  manager_.reset();
}

}  // namespace gimbal
