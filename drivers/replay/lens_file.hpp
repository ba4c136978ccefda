#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// What a calibration that another program made says of a camera.
struct LensFile {
  /// Its size is that of the calibration's pictures; the rest is zero where the file does not say.
  CameraCalibration camera;
  std::optional<Eigen::Matrix3d> R_camera_imu;
};

/// By their extensions, .json, .yaml and .yml.
[[nodiscard]] bool is_lens_file(const std::filesystem::path& path);

/// Reads a lens profile of Gyroflow (JSON), a camera chain of Kalibr (its first camera), or what
/// OpenCV's and ROS' calibrators write (YAML, camera_info). Errors name the file and the key.
[[nodiscard]] Result<LensFile> read_lens_file(const std::filesystem::path& path);

/// The camera with another size of picture, of the same shape: pixel centres have whole
/// coordinates, so what scales is the distance from the picture's corner.
[[nodiscard]] Result<CameraCalibration> fitted_to(CameraCalibration camera, ImageSize size);

}  // namespace gimbal
