#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// What a calibration has found, as far as it went.
struct FittedCalibration {
  std::optional<ImageSize> size;
  std::optional<Eigen::Matrix3d> K;
  std::optional<LensParameters> lens;  ///< with a K of its own
  std::optional<SensorDuration> readout;
  std::optional<SensorDuration> time_offset;
  std::optional<Eigen::Matrix3d> R_camera_imu;
};

/// The text of a session.toml with these values in the place of its own; everything else it says is
/// kept, but for comments. bad_input if the text is no TOML.
[[nodiscard]] Result<std::string> recalibrated_toml(std::string_view session_toml,
                                                    const FittedCalibration& fitted);

}  // namespace gimbal
