#include "daemon/live_sources.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "daemon/journal.hpp"
#include "drivers/replay/lens_file.hpp"
#include "drivers/replay/session.hpp"
#include "drivers/replay/session_toml.hpp"

namespace gimbal {
namespace {

constexpr const char* kLensNotKnown =
    "the lens is not known: give calibration = FILE under [camera], or horizontal_fov_deg, how "
    "many "
    "degrees the picture is wide";

/// Pixels are square, and the axis goes through the middle: near enough until it is calibrated.
LensParameters lens_of_view(ImageSize size, double horizontal_fov_deg) {
  const double half_rad = horizontal_fov_deg * std::numbers::pi / 360;
  const double focal_px = size.width / 2.0 / std::tan(half_rad);
  LensParameters lens;
  lens.K << focal_px, 0, (size.width - 1) / 2.0,  //
      0, focal_px, (size.height - 1) / 2.0,       //
      0, 0, 1;
  return lens;
}

/// What the calibration file says, or nothing where none is named.
Result<Session> read_calibration(const std::filesystem::path& file) {
  if (file.empty()) return Session();
  if (is_lens_file(file)) {
    return read_lens_file(file).map([](const LensFile& lens) {
      Session known;
      known.camera = lens.camera;
      known.imu.R_camera_imu = lens.R_camera_imu.value_or(Eigen::Matrix3d::Identity());
      return known;
    });
  }
  auto toml = read_session_toml(file);
  if (!toml) return tl::unexpected(toml.error());
  for (const std::string& warning : toml->warnings) log_line(LogLevel::warning, warning);
  if (!toml->session.camera) return bad_input(file.string() + ": no K under [camera]");
  return std::move(toml->session);
}

Result<CameraCalibration> lens_for(const CameraFormat& format, const Session& known,
                                   const CalibrationSettings& settings) {
  CameraCalibration camera;
  if (known.camera) {
    auto fitted = fitted_to(*known.camera, format.size);
    if (fitted && is_lens_file(settings.file)) {  // which knows nothing of a driver's stamps
      if (fitted->readout == SensorDuration::zero()) {
        fitted->readout = format.readout.value_or(SensorDuration::zero());
      }
      fitted->timestamp = format.timestamp.value_or(TimestampReference::readout_start);
    }
    return fitted;
  }
  if (!settings.horizontal_fov_deg) return bad_input(kLensNotKnown);
  camera.size = format.size;
  camera.lens = lens_of_view(format.size, *settings.horizontal_fov_deg);
  camera.readout = format.readout.value_or(SensorDuration::zero());
  camera.timestamp = format.timestamp.value_or(TimestampReference::readout_start);
  return camera;
}

ImuCalibration imu_calibration(const Session& known, const CalibrationSettings& settings) {
  ImuCalibration imu = known.imu;
  if (settings.R_camera_imu) imu.R_camera_imu = *settings.R_camera_imu;
  if (settings.imu_delay) imu.delay = settings.imu_delay;
  return imu;
}

Result<CameraCalibration> camera_calibration(const CameraFormat& format, const Session& known,
                                             const CalibrationSettings& settings) {
  auto camera = lens_for(format, known, settings);
  if (!camera) return camera;
  camera->fps = format.fps;
  if (settings.readout) camera->readout = *settings.readout;
  if (settings.readout_direction) camera->readout_direction = *settings.readout_direction;
  if (settings.time_offset) camera->time_offset = *settings.time_offset;
  if (settings.timestamp) camera->timestamp = *settings.timestamp;
  return camera;
}

/// Only a camera that runs tells what it delivers.
Result<CameraFormat> format_of(CameraSource& camera) {
  if (auto started = camera.start(); !started) return tl::unexpected(started.error());
  CameraFormat format = camera.format();
  camera.stop();
  return format;
}

/// Frames that wait for the path lie in the device's own buffers, as long as there are enough.
CameraSettings with_room_for_latency(const Configuration& configuration) {
  constexpr int kBesideThePath = 7;  // waiting for orientations, being drawn (two), being filled
  constexpr int kMostBuffers = 32;
  CameraSettings camera = configuration.camera;
  const auto latency = static_cast<int>(configuration.stabilization.latency.value_or(0));
  camera.v4l2.buffers = std::clamp(latency + kBesideThePath, camera.v4l2.buffers, kMostBuffers);
  return camera;
}

Result<LiveSources> open_devices(const Configuration& configuration) {
  const auto known = read_calibration(configuration.calibration.file);
  if (!known) return tl::unexpected(known.error());
  auto camera = open_camera(with_room_for_latency(configuration));
  if (!camera) return tl::unexpected(camera.error());
  auto imu = open_imu(configuration.imu);
  if (!imu) return tl::unexpected(imu.error());
  const auto format = format_of(**camera);
  if (!format) return tl::unexpected(format.error());
  for (const std::string& warning : format->warnings) log_line(LogLevel::warning, warning);
  const auto calibration = camera_calibration(*format, *known, configuration.calibration);
  if (!calibration) return tl::unexpected(calibration.error());
  if (calibration->readout == SensorDuration::zero()) {
    log_line(LogLevel::warning,
             "the time that the sensor takes from its first row to its last is not known, so rows "
             "count as exposed at once: give readout_s under [camera]");
  }
  LiveSources sources;
  sources.camera = std::move(*camera);
  sources.imu = std::move(*imu);
  sources.format = *format;
  sources.camera_calibration = *calibration;
  sources.imu_calibration = imu_calibration(*known, configuration.calibration);
  sources.device = known->device.empty() ? "a camera with an IMU" : known->device;
  const bool has_no_accel =
      configuration.imu.driver == ImuDriver::iio && configuration.imu.iio.accel_device == "none";
  if (has_no_accel) sources.accelerometer = Accelerometer::absent;
  return sources;
}

Result<LiveSources> open_recording(const ReplaySettings& replay) {
  const auto session = open_session(replay.session);
  if (!session) return tl::unexpected(session.error());
  for (const std::string& warning : session->warnings) log_line(LogLevel::warning, warning);
  const std::string folder = replay.session.string();
  if (session->video.empty()) return bad_input(folder + ": no video in this session");
  if (!session->camera) {
    return bad_input(folder + ": the lens is not known: give K under [camera] in session.toml");
  }
  if (session->gyro.empty()) return bad_input(folder + ": no gyro samples in this session");
  const auto timeline = std::make_shared<ReplayTimeline>(*session);
  LiveSources sources;
  sources.camera = std::make_unique<PacedCamera>(*session, timeline, replay.repeat);
  sources.imu = std::make_unique<PacedImu>(*session, timeline, replay.repeat);
  auto format = format_of(*sources.camera);
  if (!format) return tl::unexpected(format.error());
  sources.format = *std::move(format);
  sources.device = session->device;
  sources.camera_calibration = *session->camera;
  sources.imu_calibration = session->imu;
  sources.accelerometer = session->accel.empty() ? Accelerometer::absent : Accelerometer::present;
  return sources;
}

}  // namespace

Result<void> check_lens(const CalibrationSettings& settings) {
  const auto known = read_calibration(settings.file);
  if (!known) return tl::unexpected(known.error());
  if (!known->camera && !settings.horizontal_fov_deg) return bad_input(kLensNotKnown);
  return {};
}

Result<CameraCalibration> calibration_for(const CameraFormat& format,
                                          const CalibrationSettings& settings) {
  const auto known = read_calibration(settings.file);
  if (!known) return tl::unexpected(known.error());
  return camera_calibration(format, *known, settings);
}

Result<LiveSources> open_sources(const Configuration& configuration) {
  return configuration.source == SourceKind::replay ? open_recording(configuration.replay)
                                                    : open_devices(configuration);
}

}  // namespace gimbal
