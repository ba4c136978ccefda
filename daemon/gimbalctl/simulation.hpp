#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/sample/result.hpp"

namespace gimbal {

/// What `gimbalctl simulate` is asked for, in the command line's units.
struct SimulationOptions {
  std::filesystem::path output;

  std::string motion = "iphone";  ///< a model's name, or a folder with a recorded session
  double start_s = 0;             ///< of the recorded motion
  double duration_s = 10;

  std::string camera = "ipod-touch-4-720p.toml";  ///< a session.toml, or the name of one we have
  std::string size;                               ///< WIDTHxHEIGHT; empty: the camera's
  std::optional<double> fps;
  std::optional<double> readout_ms;
  std::optional<std::string> readout_direction;
  std::optional<std::string> timestamp;
  std::optional<double> time_offset_ms;
  double exposure_ms = 4;
  double frame_jitter_ms = 0;
  double drop_share = 0;
  double full_well_electrons = 8000;  ///< 0: pixels without noise

  double gyro_rate_hz = 200;
  double accel_rate_hz = 100;      ///< 0: no accelerometer
  double gyro_noise_rad_s = 1e-4;  ///< a √Hz
  double accel_noise_m_s2 = 2e-3;  ///< a √Hz
  std::array<double, 3> gyro_bias_rad_s = {0.008, -0.005, 0.012};

  std::string scene = "street";  ///< or a picture's path
  std::uint64_t seed = 1;
  bool quiet = false;  ///< no progress bar
};

/// Renders a session folder with the truth beside it.
[[nodiscard]] Result<void> simulate(const SimulationOptions& options);

}  // namespace gimbal
