#include "drivers/v4l2/v4l2_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "drivers/v4l2/controls.hpp"
#include "drivers/v4l2/sensor_timing.hpp"

namespace gimbal {
namespace {

/// Cameras take longer for their first picture than between two.
constexpr SensorDuration kLongestStart = std::chrono::seconds(5);

/// In a row, after which it is no longer a matter of single pictures.
constexpr int kMostRefused = 30;

constexpr int kFewestBuffers = 2;
constexpr int kMostBuffers = VIDEO_MAX_FRAME;

Result<void> check(const V4l2CameraSettings& settings) {
  if (settings.buffers < kFewestBuffers || settings.buffers > kMostBuffers) {
    return bad_input(fmt::format("v4l2: buffers is {}, and has to be from {} to {}",
                                 settings.buffers, kFewestBuffers, kMostBuffers));
  }
  return check_live_camera("v4l2", settings);
}

}  // namespace

V4l2Source::V4l2Source(V4l2CameraSettings settings, std::shared_ptr<const V4l2System> system)
    : settings_(std::move(settings)), system_(std::move(system)) {}

V4l2Source::~V4l2Source() {
  stop();
}

Result<void> V4l2Source::start() {
  stop();
  forget_stream();
  first_.reset();
  sequence_ = {};
  last_time_ = SensorTime::min();
  lost_ = 0;
  refused_ = 0;
  auto node = find_node(*system_, settings_.device);
  if (!node) return tl::unexpected(node.error());
  path_ = node->path;
  if (auto begun = begin(std::move(*node)); !begun) return tl::unexpected(at_camera(begun.error()));
  if (auto judged = judge_stamps(); !judged) {
    stop();
    return tl::unexpected(at_camera(judged.error()));
  }
  return {};
}

Result<void> V4l2Source::begin(V4l2Node node) {
  auto pictures = set_up(node);
  if (!pictures) return tl::unexpected(pictures.error());
  format_ = format_of(node, *pictures);
  exposure_ = fixed_exposure(*node.device);
  reader_.emplace(*pictures);
  auto stream = PictureStream::start(std::move(node.device), *pictures, settings_.buffers,
                                     system_->users_of(path_));
  if (!stream) return tl::unexpected(stream.error());
  const std::lock_guard lock(mutex_);
  stream_ = std::move(*stream);
  return {};
}

Result<PictureFormat> V4l2Source::set_up(V4l2Node& node) {
  V4l2Device& device = *node.device;
  const std::uint32_t type = node.identity.type;
  const FormatWish wish = {settings_.size ? settings_.size : current_size(device, type),
                           settings_.fps, settings_.pixel_format};
  const auto choice = choose_format(offered_formats(device, type, wish.size), wish);
  if (!choice) return tl::unexpected(choice.error());
  auto pictures = set_format(device, type, *choice, wish, system_->users_of(path_));
  if (!pictures) return pictures;
  if (auto set = set_controls(device, settings_.controls); !set) return tl::unexpected(set.error());
  return pictures;
}

CameraFormat V4l2Source::format_of(V4l2Node& node, const PictureFormat& pictures) const {
  CameraFormat format;
  format.size = pictures.size;
  format.color = pictures.color;
  format.fps = pictures.fps;
  if (const auto timing = timing_of(*system_, node)) {
    format.readout = timing->readout;
    if (format.fps == 0) format.fps = timing->fps;
  }
  if (format.fps == 0) format.fps = settings_.fps.value_or(0);
  return format;
}

/// Takes the first picture. Its stamp tells the clock; a clock that cannot be read would leave the
/// frames without a place among the inertial samples.
Result<void> V4l2Source::judge_stamps() {
  auto first = next_sound_buffer(std::max(settings_.silence_limit, kLongestStart));
  if (!first) return tl::unexpected(first.error());
  first_ = std::move(*first);
  if (!first_) return {};  // stopped
  if (settings_.stamp_source == StampSource::arrival) {
    format_.timestamp = settings_.timestamp.value_or(TimestampReference::readout_end);
    format_.warnings.emplace_back("frames are stamped on arrival, late and unevenly");
    return {};
  }
  format_.timestamp = settings_.timestamp.value_or(claimed_reference(first_->flags));
  const auto clock = find_clock(first_->stamp, clocks());
  if (!clock) {
    const auto now = clocks()(KernelClock::monotonic).value_or(SensorDuration::zero());
    return bad_input(
        fmt::format("its stamps are by none of the kernel's clocks ({:.3f} s behind "
                    "CLOCK_MONOTONIC), so that no motion can be matched to its pictures; stamping "
                    "them on arrival is possible, but uneven",
                    to_seconds(now - first_->stamp)));
  }
  clock_ = *clock;
  if (auto oddity = oddity_of(clock_, first_->flags); !oddity.empty()) {
    format_.warnings.push_back(std::move(oddity));
  }
  return {};
}

Result<std::optional<VideoFrame>> V4l2Source::read() {
  if (const auto from = stream(); !from || from->has_stopped()) return std::optional<VideoFrame>();
  for (;;) {
    auto buffer = first_ ? Result<std::optional<FilledBuffer>>(std::exchange(first_, {}))
                         : next_sound_buffer(settings_.silence_limit);
    if (!buffer) return tl::unexpected(at_camera(buffer.error()));
    if (!*buffer) return std::optional<VideoFrame>();
    if (auto frame = frame_of(**buffer)) {
      refused_ = 0;
      return frame;
    }
    if (++refused_ >= kMostRefused) {
      return tl::unexpected(at_camera(
          {Error::Kind::failed, fmt::format("{} pictures in a row are damaged, or have stamps "
                                            "that do not rise",
                                            refused_)}));
    }
  }
}

/// Those that the driver has marked as damaged are counted and go back.
Result<std::optional<FilledBuffer>> V4l2Source::next_sound_buffer(SensorDuration limit) {
  const auto from = stream();
  if (!from) return std::optional<FilledBuffer>();
  for (;;) {
    auto buffer = from->next(limit);
    if (!buffer || !*buffer) return buffer;
    const auto step = sequence_.next((*buffer)->sequence);
    lost_ += step.lost;
    index_ = step.index;
    if (((*buffer)->flags & V4L2_BUF_FLAG_ERROR) == 0) return buffer;
    ++lost_;
    from->give_back((*buffer)->index);
  }
}

/// Nothing, and a loss, where the picture is damaged or its stamp does not rise.
std::optional<VideoFrame> V4l2Source::frame_of(const FilledBuffer& buffer) {
  const auto from = stream();
  const SensorTime time = time_of(buffer);
  if (time <= last_time_) {
    ++lost_;
    from->give_back(buffer.index);
    return std::nullopt;
  }
  auto frame = reader_->read(buffer, *from, {index_, time, exposure_}, form_);
  if (!frame) {
    ++lost_;
    return std::nullopt;
  }
  last_time_ = time;
  return frame;
}

SensorTime V4l2Source::time_of(const FilledBuffer& buffer) const {
  if (settings_.stamp_source == StampSource::device) {
    return to_monotonic(buffer.stamp, clock_, clocks());
  }
  return SensorTime(clocks()(KernelClock::monotonic).value_or(buffer.stamp));
}

ReadClock V4l2Source::clocks() const {
  return [from = stream()](KernelClock clock) { return from->read_clock(clock); };
}

/// Frames that are out keep their buffers; the device is free for the next `start`.
void V4l2Source::stop() {
  if (const auto running = stream()) running->stop();
}

void V4l2Source::forget_stream() {
  const std::lock_guard lock(mutex_);
  stream_.reset();
}

std::shared_ptr<PictureStream> V4l2Source::stream() const {
  const std::lock_guard lock(mutex_);
  return stream_;
}

Error V4l2Source::at_camera(const Error& error) const {
  return {error.kind, path_ + ": " + error.message};
}

Result<std::unique_ptr<CameraSource>> open_v4l2_camera(V4l2CameraSettings settings) {
  if (auto checked = check(settings); !checked) return tl::unexpected(checked.error());
  return std::make_unique<V4l2Source>(std::move(settings), kernel_v4l2());
}

std::vector<DeviceReport> list_v4l2_cameras() {
  return report_nodes(*kernel_v4l2());
}

}  // namespace gimbal
