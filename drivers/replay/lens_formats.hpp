#pragma once

#include <filesystem>

#include "drivers/replay/lens_file.hpp"

namespace gimbal {

// One a format. Errors name the key; the caller adds the file.

/// Models "opencv_fisheye" and "opencv_standard". The axis goes through the middle of the picture
/// unless the profile calls itself asymmetrical, as Gyroflow takes it.
[[nodiscard]] Result<LensFile> read_gyroflow_profile(const std::filesystem::path& path);

/// Tells the kinds apart by their keys. Kalibr's time shift is IMU time less camera time, as ours.
[[nodiscard]] Result<LensFile> read_calibration_yaml(const std::filesystem::path& path);

}  // namespace gimbal
