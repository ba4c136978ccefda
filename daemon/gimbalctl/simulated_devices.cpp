#include "daemon/gimbalctl/simulated_devices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "daemon/gimbalctl/data_files.hpp"
#include "daemon/gimbalctl/picture_size.hpp"
#include "drivers/replay/replay_camera.hpp"
#include "drivers/replay/session_toml.hpp"
#include "drivers/synthetic/hand_motion.hpp"
#include "drivers/synthetic/picture_scene.hpp"
#include "drivers/synthetic/recorded_motion.hpp"
#include "drivers/synthetic/street_scene.hpp"

namespace gimbal {
namespace {

/// Clocks have run for a while when a recording begins, so that no stamp is below zero.
constexpr SensorDuration kClockAtStart = std::chrono::seconds(1);
/// The IMU is on a little before the first frame and after the last.
constexpr SensorDuration kLead = std::chrono::milliseconds(200);

SensorDuration milliseconds_of(double ms) {
  return duration_from_seconds(ms * 1e-3);
}

// --- motion -----------------------------------------------------------------------------------

const std::map<std::string, HandModel (*)()>& hand_models() {
  static const std::map<std::string, HandModel (*)()> models = {{"walk", walking_hand},
                                                                {"run", running_hand},
                                                                {"pan", panning_hand},
                                                                {"vehicle", vehicle_mount},
                                                                {"tripod", tripod}};
  return models;
}

Result<std::filesystem::path> find_motion_log(const std::string& name) {
  std::error_code ignored;
  if (std::filesystem::exists(name, ignored)) return name;
  return find_data_file("motions", name == "iphone" ? "iphone-handheld" : name)
      .map_error([&](Error error) {
        error.message += "; or walk, run, pan, vehicle, tripod";
        return error;
      });
}

Result<Motion> load_recorded_motion(const SimulationOptions& options) {
  const Result<std::filesystem::path> path = find_motion_log(options.motion);
  if (!path) return tl::unexpected(path.error());
  const Result<Session> log = open_session(*path);
  if (!log) return tl::unexpected(log.error());
  return make_recorded_motion({log->gyro, log->accel, log->imu.R_camera_imu},
                              duration_from_seconds(options.start_s),
                              duration_from_seconds(options.duration_s))
      .map_error([&](Error error) {
        error.message = fmt::format("{}: {}", path->string(), error.message);
        return error;
      });
}

// --- camera -----------------------------------------------------------------------------------

/// The same view in another size: K with pixel centres at whole coordinates.
void resize(CameraCalibration& camera, ImageSize size) {
  const double x = static_cast<double>(size.width) / camera.size.width;
  const double y = static_cast<double>(size.height) / camera.size.height;
  Eigen::Matrix3d& K = camera.lens.K;
  K(0, 0) *= x;
  K(1, 1) *= y;
  K(0, 2) = (K(0, 2) + 0.5) * x - 0.5;
  K(1, 2) = (K(1, 2) + 0.5) * y - 0.5;
  camera.size = size;
}

template <typename T>
Result<T> choice(const char* option, const std::string& word,
                 const std::map<std::string, T>& choices) {
  const auto found = choices.find(word);
  if (found != choices.end()) return found->second;
  std::string allowed;
  for (const auto& [name, value] : choices) allowed += (allowed.empty() ? "" : ", ") + name;
  return bad_input(fmt::format("{} {}: choose one of {}", option, word, allowed));
}

Result<void> apply_words(const SimulationOptions& options, CameraCalibration& camera) {
  if (options.readout_direction) {
    const auto direction =
        choice<ReadoutDirection>("--readout-direction", *options.readout_direction,
                                 {{"top-down", ReadoutDirection::top_down},
                                  {"bottom-up", ReadoutDirection::bottom_up},
                                  {"left-right", ReadoutDirection::left_right},
                                  {"right-left", ReadoutDirection::right_left}});
    if (!direction) return tl::unexpected(direction.error());
    camera.readout_direction = *direction;
  }
  if (options.timestamp) {
    const auto reference =
        choice<TimestampReference>("--timestamp", *options.timestamp,
                                   {{"readout-start", TimestampReference::readout_start},
                                    {"exposure-start", TimestampReference::exposure_start},
                                    {"readout-end", TimestampReference::readout_end}});
    if (!reference) return tl::unexpected(reference.error());
    camera.timestamp = *reference;
  }
  return {};
}

// --- scene ------------------------------------------------------------------------------------

Result<VideoFrame> load_picture(const std::string& path) {
  ReplayCamera picture(path, {FrameStamp{}}, 1.0);
  if (Result<void> started = picture.start(); !started) return tl::unexpected(started.error());
  Result<std::optional<VideoFrame>> frame = picture.read();
  if (!frame) return tl::unexpected(frame.error());
  if (!*frame) return bad_input(fmt::format("{}: there is no picture in it", path));
  return **frame;
}

Result<std::shared_ptr<const Panorama>> make_panorama(const SimulationOptions& options,
                                                      const CameraCalibration& camera) {
  constexpr double kPictureWidth_rad = 100.0 * std::numbers::pi / 180.0;
  constexpr int kSamples = 2;
  const double pixels_per_radian = std::max(camera.lens.K(0, 0), camera.lens.K(1, 1));
  if (options.scene == "street") {
    return std::make_shared<const Panorama>(
        std::make_shared<StreetScene>(options.seed, 1.0 / pixels_per_radian), pixels_per_radian,
        kSamples);
  }
  Result<VideoFrame> picture = load_picture(options.scene);
  if (!picture) return tl::unexpected(picture.error());
  return std::make_shared<const Panorama>(
      std::make_shared<PictureScene>(*std::move(picture), kPictureWidth_rad), pixels_per_radian,
      kSamples);
}

// --- devices ----------------------------------------------------------------------------------

}  // namespace

Result<void> check(const SimulationOptions& options) {
  const auto within = [](double value, double least, double most) {
    return value >= least && value <= most;  // false for what is not a number
  };
  struct Limit {
    const char* option;
    double value;
    double least;
    double most;
    const char* unit;
  };
  const std::array limits = {
      Limit{"--time-offset", options.time_offset_ms.value_or(0), -1e7, 1e7, "ms"},
      Limit{"--exposure", options.exposure_ms, 0, 1e4, "ms"},
      Limit{"--readout", options.readout_ms.value_or(0), 0, 1e4, "ms"},
      Limit{"--frame-jitter", options.frame_jitter_ms, 0, 1e3, "ms"},
      Limit{"--full-well", options.full_well_electrons, 0, 1e9, "electrons"},
      Limit{"--accel-rate", options.accel_rate_hz, 0, 1e4, "Hz"},
      Limit{"--gyro-noise", options.gyro_noise_rad_s, 0, 10, "rad/s/√Hz"},
      Limit{"--accel-noise", options.accel_noise_m_s2, 0, 100, "m/s²/√Hz"},
      Limit{"--gyro-bias", options.gyro_bias_rad_s[0], -100, 100, "rad/s"},
      Limit{"--gyro-bias", options.gyro_bias_rad_s[1], -100, 100, "rad/s"},
      Limit{"--gyro-bias", options.gyro_bias_rad_s[2], -100, 100, "rad/s"},
  };
  for (const Limit& limit : limits) {
    if (within(limit.value, limit.least, limit.most)) continue;
    return bad_input(fmt::format("{} {}: must lie between {} and {} {}", limit.option, limit.value,
                                 limit.least, limit.most, limit.unit));
  }
  if (!within(options.duration_s, 0.1, 3600)) {
    return bad_input(
        fmt::format("--duration {}: must lie between 0.1 and 3600 s", options.duration_s));
  }
  if (!within(options.start_s, 0, 1e6)) {
    return bad_input(fmt::format("--start {}: must not be negative", options.start_s));
  }
  if (!within(options.drop_share, 0, 0.9)) {
    return bad_input(
        fmt::format("--drop-frames {}: must lie between 0 and 0.9", options.drop_share));
  }
  if (!within(options.gyro_rate_hz, 1, 1e4)) {
    return bad_input(
        fmt::format("--gyro-rate {}: must lie between 1 and 10000 Hz", options.gyro_rate_hz));
  }
  return {};
}

Result<Motion> make_motion(const SimulationOptions& options) {
  const auto model = hand_models().find(options.motion);
  const Result<Motion> motion =
      model == hand_models().end()
          ? load_recorded_motion(options)
          : make_hand_motion(model->second(), duration_from_seconds(options.duration_s),
                             options.seed);
  if (!motion) return tl::unexpected(motion.error());
  return motion->delayed(kClockAtStart);
}

Result<Session> load_camera(const SimulationOptions& options) {
  std::error_code ignored;
  const Result<std::filesystem::path> path = std::filesystem::exists(options.camera, ignored)
                                                 ? Result<std::filesystem::path>(options.camera)
                                                 : find_data_file("cameras", options.camera);
  if (!path) return tl::unexpected(path.error());
  Result<SessionToml> toml = read_session_toml(*path);
  if (!toml) return tl::unexpected(toml.error());
  Session session = std::move(toml->session);
  if (!session.camera || session.camera->fps <= 0) {
    return bad_input(
        fmt::format("{}: needs a [camera] table with width, height, fps and K", path->string()));
  }
  CameraCalibration& camera = *session.camera;
  if (!options.size.empty()) {
    const Result<ImageSize> size = parse_picture_size(options.size);
    if (!size) return tl::unexpected(size.error());
    resize(camera, *size);
  }
  camera.fps = options.fps.value_or(camera.fps);
  if (options.readout_ms) camera.readout = milliseconds_of(*options.readout_ms);
  if (options.time_offset_ms) camera.time_offset = milliseconds_of(*options.time_offset_ms);
  if (Result<void> applied = apply_words(options, camera); !applied)
    return tl::unexpected(applied.error());
  return session;
}

Result<std::unique_ptr<SyntheticCamera>> make_camera(const SimulationOptions& options,
                                                     const CameraCalibration& calibration,
                                                     std::shared_ptr<const Motion> motion) {
  SyntheticCameraSettings settings;
  settings.calibration = calibration;
  settings.exposure = milliseconds_of(options.exposure_ms);
  settings.first_readout = SensorTime(kClockAtStart);
  settings.frames = std::llround(options.duration_s * calibration.fps);
  settings.interval_jitter = milliseconds_of(options.frame_jitter_ms);
  settings.drop_probability = options.drop_share;
  if (options.full_well_electrons > 0) {
    settings.noise = PixelNoise{.full_well_electrons = options.full_well_electrons};
  }
  settings.seed = options.seed;
  const auto panorama = make_panorama(options, calibration);
  if (!panorama) return tl::unexpected(panorama.error());
  return SyntheticCamera::create(settings, std::move(motion), *panorama);
}

Result<std::unique_ptr<SyntheticImu>> make_imu(const SimulationOptions& options,
                                               const ImuCalibration& calibration,
                                               const Motion& motion) {
  SyntheticImuSettings settings;
  settings.R_camera_imu = calibration.R_camera_imu;
  settings.span.from = SensorTime(kClockAtStart - kLead);
  settings.span.to = SensorTime(kClockAtStart + duration_from_seconds(options.duration_s) + kLead);
  settings.gyro_clock.rate_hz = options.gyro_rate_hz;
  settings.accel_clock = {options.accel_rate_hz, std::chrono::microseconds(1300)};
  settings.gyro.noise_density = options.gyro_noise_rad_s;
  settings.gyro.bias = Eigen::Map<const Eigen::Vector3d>(options.gyro_bias_rad_s.data());
  settings.accel.noise_density = options.accel_noise_m_s2;
  settings.seed = options.seed;
  return SyntheticImu::create(settings, motion);
}

}  // namespace gimbal
