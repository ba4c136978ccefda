#include "drivers/libcamera/libcamera_source.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>
#include <vector>

#include "drivers/libcamera/camera_manager.hpp"

namespace gimbal {
namespace {

/// Cameras take longer for their first picture than between two.
constexpr SensorDuration kLongestStart = std::chrono::seconds(5);

/// In a row, after which it is no longer a matter of single pictures.
constexpr int kMostRefused = 30;

}  // namespace

LibcameraSource::LibcameraSource(LibcameraSettings settings) : settings_(std::move(settings)) {}

LibcameraSource::~LibcameraSource() {
  stop();
}

Result<void> LibcameraSource::start() {
  stop();
  forget_session();
  first_.reset();
  sequence_ = {};
  last_time_ = SensorTime::min();
  lost_ = 0;
  refused_ = 0;
  id_.clear();
  auto begun = begin();
  if (begun) begun = judge_first_picture();
  if (begun) return {};
  stop();
  return tl::unexpected(at_camera(begun.error()));
}

Result<void> LibcameraSource::begin() {
  auto manager = camera_manager();
  if (!manager) return tl::unexpected(manager.error());
  auto camera = find_camera(**manager, settings_.camera);
  if (!camera) return tl::unexpected(camera.error());
  id_ = (*camera)->id();
  auto session = CameraSession::start(std::move(*manager), std::move(*camera), settings_);
  if (!session) return tl::unexpected(session.error());
  format_ = {};
  format_.size = (*session)->pictures().size;
  format_.color = (*session)->pictures().color;
  format_.fps = settings_.fps.value_or(0);
  format_.timestamp = settings_.timestamp;
  format_.warnings = (*session)->warnings();
  const std::lock_guard lock(mutex_);
  session_ = std::move(*session);
  return {};
}

/// libcamera documents its stamps as of CLOCK_BOOTTIME, while the pipelines pass those of V4L2 on,
/// of CLOCK_MONOTONIC. The two part at the first suspend.
Result<void> LibcameraSource::judge_first_picture() {
  auto first = next_sound_picture(std::max(settings_.silence_limit, kLongestStart));
  if (!first) return tl::unexpected(first.error());
  first_ = *first;
  if (!first_) return {};  // stopped
  if (first_->frame_duration) format_.fps = 1 / to_seconds(*first_->frame_duration);
  const auto clock = find_clock(*first_->stamp, read_kernel_clock);
  if (!clock) {
    return bad_input(
        "its stamps are by none of the kernel's clocks, so that no motion can be matched to its "
        "pictures");
  }
  clock_ = *clock;
  if (clock_ != KernelClock::monotonic) {
    format_.warnings.push_back(fmt::format(
        "its stamps are by {}; they are converted to CLOCK_MONOTONIC", name_of(clock_)));
  }
  return {};
}

Result<std::optional<VideoFrame>> LibcameraSource::read() {
  const auto from = session();
  if (!from || from->has_stopped()) return std::optional<VideoFrame>();
  while (refused_ < kMostRefused) {
    auto picture = first_ ? Result<std::optional<CapturedPicture>>(std::exchange(first_, {}))
                          : next_sound_picture(settings_.silence_limit);
    if (!picture) return tl::unexpected(at_camera(picture.error()));
    if (!*picture) return std::optional<VideoFrame>();
    const SensorTime time = to_monotonic(*(*picture)->stamp, clock_, read_kernel_clock);
    if (time > last_time_) {
      last_time_ = time;
      refused_ = 0;
      return frame_of(**picture, {index_, time, (*picture)->exposure});
    }
    from->give_back((*picture)->buffer);
    ++lost_;
    ++refused_;
  }
  return tl::unexpected(at_camera(
      {Error::Kind::failed, fmt::format("the stamps of {} pictures do not rise", refused_)}));
}

/// Those that are damaged, or have no stamp, are counted and go back.
Result<std::optional<CapturedPicture>> LibcameraSource::next_sound_picture(SensorDuration limit) {
  const auto from = session();
  if (!from) return std::optional<CapturedPicture>();
  for (int damaged = 0; damaged < kMostRefused; ++damaged) {
    auto picture = from->next(limit);
    if (!picture || !*picture) return picture;
    const auto step = sequence_.next((*picture)->sequence);
    lost_ += step.lost;
    index_ = step.index;
    if (!(*picture)->is_damaged && (*picture)->stamp) return picture;
    ++lost_;
    from->give_back((*picture)->buffer);
  }
  return failed(fmt::format("{} pictures in a row are damaged, or have no stamp", kMostRefused));
}

namespace {

/// Where the picture lies, as what it is.
void point_to(const std::vector<MappedPlane>& mapped, LibcameraLayout layout, VideoFrame& frame) {
  const auto format = native_format(layout);
  if (!format) {
    frame.planes = {mapped[0].plane, mapped[1].plane};
    frame.dma_buf = {
        {{mapped[0].fd, mapped[0].offset_bytes}, {mapped[1].fd, mapped[1].offset_bytes}}};
    return;
  }
  NativePicture& native = frame.native.emplace();
  native.format = *format;
  auto& dma_buf = native.dma_buf.emplace();
  for (std::size_t i = 0; i < mapped.size(); ++i) {
    native.planes[i] = mapped[i].plane;
    dma_buf[i] = {mapped[i].fd, mapped[i].offset_bytes};
  }
}

}  // namespace

VideoFrame LibcameraSource::frame_of(const CapturedPicture& picture,
                                     const FrameStamp& stamp) const {
  const auto from = session();
  const LibcameraPictures& pictures = from->pictures();
  const std::vector<MappedPlane>& mapped = from->planes(picture.buffer);
  const bool can_stay = !native_format(pictures.layout) || form_ == PictureForm::native;
  auto lease = can_stay ? from->lend(picture.buffer) : nullptr;
  if (lease) {
    VideoFrame frame;
    frame.stamp = stamp;
    frame.size = pictures.size;
    frame.color = pictures.color;
    frame.storage = std::move(lease);
    point_to(mapped, pictures.layout, frame);
    return frame;
  }
  std::vector<ConstPlane> planes;
  planes.reserve(mapped.size());
  for (const MappedPlane& plane : mapped) planes.push_back(plane.plane);
  auto copy = converted(pictures, planes);
  from->give_back(picture.buffer);
  return std::move(copy).publish(stamp, pictures.color);
}

/// Frames that are out keep their buffers; the camera is free for the next `start`.
void LibcameraSource::stop() {
  if (const auto running = session()) running->stop();
}

std::shared_ptr<CameraSession> LibcameraSource::session() const {
  const std::lock_guard lock(mutex_);
  return session_;
}

void LibcameraSource::forget_session() {
  const std::lock_guard lock(mutex_);
  session_.reset();
}

Error LibcameraSource::at_camera(const Error& error) const {
  if (id_.empty()) return error;  // there is none yet
  return {error.kind, id_ + ": " + error.message};
}

Result<std::unique_ptr<CameraSource>> open_libcamera_camera(LibcameraSettings settings) {
  if (auto checked = check_live_camera("libcamera", settings); !checked) {
    return tl::unexpected(checked.error());
  }
  return std::make_unique<LibcameraSource>(std::move(settings));
}

namespace {

DeviceReport report_on(libcamera::Camera& camera) {
  DeviceReport report{"libcamera", camera.id(), model_of(camera), {}, {}};
  const auto configuration = camera.generateConfiguration({libcamera::StreamRole::VideoRecording});
  if (!configuration || configuration->empty()) {
    report.obstacle = "delivers no video";
    return report;
  }
  const auto& formats = configuration->at(0).formats();
  bool is_readable = false;
  for (const libcamera::PixelFormat& format : formats.pixelformats()) {
    const libcamera::SizeRange range = formats.range(format);
    report.details.push_back(
        fmt::format("{}: {} to {}", format.toString(), range.min.toString(), range.max.toString()));
    is_readable = is_readable ||
                  std::ranges::any_of(known_libcamera_formats(),
                                      [&](const auto& known) { return known.format == format; });
  }
  if (!is_readable) report.obstacle = "offers neither NV12, YUV420, RGB888 nor BGR888";
  std::vector<std::string> names;
  for (const auto& [id, info] : camera.controls()) names.push_back(id->name());
  std::ranges::sort(names);
  if (!names.empty()) report.details.push_back(fmt::format("controls: {}", fmt::join(names, ", ")));
  if (camera.acquire() != 0) {
    report.obstacle = "busy: another program has it";
  } else {
    static_cast<void>(camera.release());
  }
  return report;
}

}  // namespace

std::vector<DeviceReport> list_libcamera_cameras() {
  const auto manager = camera_manager();
  if (!manager) return {{"libcamera", "", "", {}, manager.error().message}};
  std::vector<DeviceReport> reports;
  for (const auto& camera : (*manager)->cameras()) reports.push_back(report_on(*camera));
  return reports;
}

}  // namespace gimbal
