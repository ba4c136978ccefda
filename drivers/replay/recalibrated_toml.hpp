#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// What a fit of camera and IMU has found.
struct FittedCalibration {
  Eigen::Matrix3d K;
  SensorDuration readout{};
  SensorDuration time_offset{};
  Eigen::Matrix3d R_camera_imu;
};

/// The text of a session.toml with these values in the place of its own; everything else it says is
/// kept, but for comments. bad_input if the text is no TOML.
[[nodiscard]] Result<std::string> recalibrated_toml(std::string_view session_toml,
                                                    const FittedCalibration& fitted);

}  // namespace gimbal
