#include "drivers/synthetic/synthetic_camera.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/synthetic/random.hpp"
#include "drivers/synthetic/ray_table.hpp"
#include "pipeline/lens/lens.hpp"

namespace gimbal {
namespace {

constexpr double kBlurStep_px = 1.0;  // a point moves no further between two looks of an exposure
constexpr int kMostLooks = 64;        // more would not be seen in so long a streak

constexpr std::uint64_t kTimingStream = 0;
constexpr std::uint64_t kPixelStream = 1;

Result<void> check(const SyntheticCameraSettings& settings) {
  const CameraCalibration& camera = settings.calibration;
  if (camera.size.width < 1 || camera.size.height < 1) {
    return bad_input(fmt::format("synthetic camera: size {}x{}: give at least one pixel",
                                 camera.size.width, camera.size.height));
  }
  if (!std::isfinite(camera.fps) || camera.fps <= 0.0) {
    return bad_input(fmt::format("synthetic camera: {} frames/s: must be above zero", camera.fps));
  }
  const SensorDuration interval = duration_from_seconds(1.0 / camera.fps);
  if (camera.readout < SensorDuration::zero() || camera.readout > interval) {
    return bad_input(fmt::format(
        "synthetic camera: readout of {} ms: must lie between 0 and the frame interval, {} ms",
        1e3 * to_seconds(camera.readout), 1e3 * to_seconds(interval)));
  }
  if (settings.exposure < SensorDuration::zero() || settings.exposure > interval) {
    return bad_input(fmt::format(
        "synthetic camera: exposure of {} ms: must lie between 0 and the frame interval, {} ms",
        1e3 * to_seconds(settings.exposure), 1e3 * to_seconds(interval)));
  }
  return {};
}

std::vector<SensorTime> draw_readout_starts(const SyntheticCameraSettings& settings) {
  Random random(stream_seed(settings.seed, kTimingStream));
  const double interval_s = 1.0 / settings.calibration.fps;
  const double jitter_s = to_seconds(settings.interval_jitter);
  std::vector<SensorTime> starts;
  for (std::int64_t i = 0; i < settings.frames; ++i) {
    // Half an interval at most, so that stamps rise whatever is drawn.
    const double late_s =
        std::clamp(jitter_s * random.normal(), -0.45 * interval_s, 0.45 * interval_s);
    const bool dropped = random.uniform() < settings.drop_probability && i > 0;
    if (dropped) continue;
    starts.push_back(settings.first_readout +
                     duration_from_seconds(static_cast<double>(i) * interval_s + late_s));
  }
  return starts;
}

}  // namespace

Result<std::unique_ptr<SyntheticCamera>> SyntheticCamera::create(
    const SyntheticCameraSettings& settings, std::shared_ptr<const Motion> motion,
    std::shared_ptr<const Panorama> panorama) {
  if (Result<void> checked = check(settings); !checked) return tl::unexpected(checked.error());
  const CameraCalibration& camera = settings.calibration;
  Result<Lens> lens = Lens::create(camera.lens);
  if (!lens) return tl::unexpected(lens.error());
  PictureRenderer renderer(std::move(panorama),
                           RayTable(*lens, camera.size, line_axis(camera.readout_direction)),
                           settings.noise);
  return std::unique_ptr<SyntheticCamera>(
      new SyntheticCamera(settings, std::move(motion), std::move(renderer)));
}

SyntheticCamera::SyntheticCamera(SyntheticCameraSettings settings,
                                 std::shared_ptr<const Motion> motion, PictureRenderer renderer)
    : settings_(std::move(settings)),
      motion_(std::move(motion)),
      renderer_(std::move(renderer)),
      readout_starts_(draw_readout_starts(settings_)) {}

Result<void> SyntheticCamera::start() {
  next_frame_ = 0;
  running_ = true;
  return {};
}

void SyntheticCamera::stop() {
  running_ = false;
}

CameraFormat SyntheticCamera::format() const {
  return {settings_.calibration.size, settings_.calibration.fps, PictureRenderer::color()};
}

int SyntheticCamera::line_count() const {
  return gimbal::line_count(settings_.calibration.size,
                            line_axis(settings_.calibration.readout_direction));
}

FrameStamp SyntheticCamera::stamp(std::size_t frame) const {
  SensorTime instant = readout_starts_[frame];
  switch (settings_.calibration.timestamp) {
    case TimestampReference::readout_start:
      break;
    case TimestampReference::exposure_start:
      instant -= settings_.exposure;  // a line is read out as soon as it has been exposed
      break;
    case TimestampReference::readout_end:
      instant += settings_.calibration.readout;
      break;
  }
  return {static_cast<std::int64_t>(frame), instant - settings_.calibration.time_offset,
          settings_.exposure};
}

SensorTime SyntheticCamera::time_of_line(std::size_t frame, int line) const {
  const ReadoutDirection direction = settings_.calibration.readout_direction;
  const bool backwards =
      direction == ReadoutDirection::bottom_up || direction == ReadoutDirection::right_left;
  const int lines = line_count();
  const int read_before = backwards ? lines - 1 - line : line;
  const SensorTime readout =
      readout_starts_[frame] + settings_.calibration.readout * read_before / lines;
  return readout - settings_.exposure / 2;
}

std::vector<Eigen::Matrix3f> SyntheticCamera::expose(std::size_t frame, int line) const {
  const SensorTime middle = time_of_line(frame, line);
  const Eigen::Matrix3d& K = settings_.calibration.lens.K;
  const double blur_px = motion_->at(middle).rate_rad_s.norm() * to_seconds(settings_.exposure) *
                         std::max(K(0, 0), K(1, 1));
  const int looks = std::clamp(static_cast<int>(std::ceil(blur_px / kBlurStep_px)), 1, kMostLooks);
  std::vector<Eigen::Matrix3f> poses;
  for (int i = 0; i < looks; ++i) {
    const SensorTime time = middle + settings_.exposure * (2 * i + 1 - looks) / (2 * looks);
    poses.push_back(motion_->at(time).q_world_camera.toRotationMatrix().cast<float>());
  }
  return poses;
}

Result<std::optional<VideoFrame>> SyntheticCamera::read() {
  if (!running_ || next_frame_ == frame_count()) return std::nullopt;
  const std::size_t frame = next_frame_++;
  const std::uint64_t noise_seed = stream_seed(stream_seed(settings_.seed, kPixelStream), frame);
  return renderer_.draw(
      stamp(frame), [&](int line) { return expose(frame, line); }, noise_seed);
}

}  // namespace gimbal
