#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/imu_sample.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// A recording: what a session folder holds (see SESSION_FORMAT.md). Acceleration is specific force
/// in m/s² here, whatever the file has.
struct Session {
  std::filesystem::path folder;
  std::string device;
  std::string recorded_at;  ///< RFC 3339; empty if unknown
  std::string quality;
  std::optional<CameraCalibration> camera;
  ImuCalibration imu;
  std::filesystem::path video;  ///< empty if there is none
  std::vector<FrameStamp> frames;
  std::vector<GyroSample> gyro;
  std::vector<AccelSample> accel;
  /// What was odd and how it was handled, a line each: gaps, steps back, late starts.
  std::vector<std::string> warnings;
};

/// Opens a session folder, or a video with a Gyroflow log (same name, .gcsv) beside it.
[[nodiscard]] Result<Session> open_session(const std::filesystem::path& path);

/// Writes session.toml and the CSV files into `session.folder`, and copies the video there.
[[nodiscard]] Result<void> write_session(const Session& session);

}  // namespace gimbal
