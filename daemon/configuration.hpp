#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/bias_memory_settings.hpp"
#include "daemon/control_address.hpp"
#include "daemon/gpio_settings.hpp"
#include "daemon/output_target.hpp"
#include "daemon/recording_settings.hpp"
#include "daemon/stabilization.hpp"
#include "daemon/sync_settings.hpp"
#include "drivers/driver_table.hpp"
#include "drivers/replay/paced_replay.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// A recording that plays the part of camera and IMU.
struct ReplaySettings {
  std::filesystem::path session;
  Repeat repeat = Repeat::forever;

  bool operator==(const ReplaySettings&) const = default;
};

/// What is known of a camera and its IMU, beside what the devices tell.
struct CalibrationSettings {
  /// With the tables [camera] and [imu] of a session.toml; empty for none.
  std::filesystem::path file;
  /// Across the picture, of a lens that was not calibrated.
  std::optional<double> horizontal_fov_deg;
  // What these say goes before the file.
  std::optional<SensorDuration> readout;
  std::optional<ReadoutDirection> readout_direction;
  std::optional<SensorDuration> time_offset;
  std::optional<TimestampReference> timestamp;
  std::optional<Eigen::Matrix3d> R_camera_imu;
  std::optional<SensorDuration> imu_delay;

  bool operator==(const CalibrationSettings&) const = default;
};

/// Where frames and samples come from.
enum class SourceKind : std::uint8_t { devices, replay };

/// What the daemon is told to do. See config/examples.
struct Configuration {
  SourceKind source = SourceKind::replay;
  ReplaySettings replay;
  CameraSettings camera;
  ImuSettings imu;
  CalibrationSettings calibration;
  BiasMemorySettings bias_memory;
  SyncSettings sync;
  StabilizationSettings stabilization;
  std::vector<OutputSettings> outputs;
  ControlSettings control;
  RecordingSettings recording;
  GpioSettings gpio;
};

/// Where the daemon looks if it is not told: /etc/gimbald/gimbald.toml, then
/// /etc/gimbald/conf.d/*.toml in the order of their names. Fails if there is none.
[[nodiscard]] Result<std::vector<std::filesystem::path>> usual_configuration_files();

/// Which IMU is used, by its driver and its place: letters, digits, dots, dashes and underscores,
/// so that it may be part of a file's name.
[[nodiscard]] std::string imu_name(const Configuration& configuration);

/// Reads the files in order; a later one overrides single keys of an earlier one. Fails with file,
/// line, key, what was found and what is allowed; a key that is not known is an error.
[[nodiscard]] Result<Configuration> load_configuration(
    std::span<const std::filesystem::path> files);

}  // namespace gimbal
