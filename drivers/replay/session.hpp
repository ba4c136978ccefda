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
/// in m/s² here, whatever the file has. Stamps rise strictly in each log of an opened session.
struct Session {
  std::filesystem::path folder;
  std::string device;
  std::string recorded_at;  ///< RFC 3339; empty if unknown
  std::string quality;
  std::optional<CameraCalibration> camera;
  /// What is known while the lens is not calibrated and `camera` is empty: `lens` means nothing.
  std::optional<CameraCalibration> camera_without_lens;
  ImuCalibration imu;
  std::string imu_clock;        ///< the recording's name for the clock of its inertial stamps
  std::filesystem::path video;  ///< empty if there is none
  /// `index` is the picture's place in the video, from 0. A picture without a stamp has no usable
  /// time and is to be left out.
  std::vector<FrameStamp> frames;
  std::vector<GyroSample> gyro;
  std::vector<AccelSample> accel;
  /// What was odd and how it was handled, a line each: gaps, steps back, late starts.
  std::vector<std::string> warnings;
  /// Where the numbers come from: comments for the head of a session.toml to be written, a line
  /// each.
  std::vector<std::string> notes;
};

/// Opens a session folder, or a video with a Gyroflow log (same name, .gcsv) beside it.
[[nodiscard]] Result<Session> open_session(const std::filesystem::path& path);

/// Writes session.toml and the CSV files into `session.folder`, which is made if it does not exist,
/// and copies the video there unless it is there already. Times keep every nanosecond.
[[nodiscard]] Result<void> write_session(const Session& session);

/// Makes a folder for a new session. Refuses a path that exists, unless it is an empty folder.
[[nodiscard]] Result<void> make_session_folder(const std::filesystem::path& folder);

}  // namespace gimbal
