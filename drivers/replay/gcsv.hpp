#pragma once

#include <filesystem>

#include "drivers/replay/session.hpp"
#include "drivers/replay/session_logs.hpp"

namespace gimbal {

/// A Gyroflow log (.gcsv, version 1.3): what its header says of the camera, and its samples.
struct GyroflowLog {
  std::string device;
  std::string note;
  SensorDuration readout{};
  ReadoutDirection readout_direction = ReadoutDirection::top_down;
  GyroLog gyro;    ///< in Gyroflow's axes, see `R_camera_gyroflow`
  AccelLog accel;  ///< as above
};

/// Gyroflow's axes, once the header's orientation was applied: with the lens level, x up, y left
/// and z back. Source: Gyroflow's documentation, "orientation".
[[nodiscard]] Eigen::Matrix3d R_camera_gyroflow();

/// Source: docs.gyroflow.xyz, "GCSV format". Rows with values that are not finite are left out and
/// counted in `warnings`.
[[nodiscard]] Result<GyroflowLog> read_gcsv(const std::filesystem::path& path,
                                            std::vector<std::string>& warnings);

/// The log beside a video: the same name, ending in .gcsv; empty if there is none.
[[nodiscard]] std::filesystem::path gcsv_beside(const std::filesystem::path& video);

/// A video and the log beside it, stamps as they are. There are no frame times but the container's,
/// and how they lie to the log's is not known: 0 is taken, and said in the warnings.
[[nodiscard]] Result<std::pair<Session, SessionLogs>> read_gyroflow_recording(
    const std::filesystem::path& video, const std::filesystem::path& log);

}  // namespace gimbal
