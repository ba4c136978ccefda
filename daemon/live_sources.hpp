#pragma once

#include "daemon/configuration.hpp"
#include "daemon/live_pipeline.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Camera and IMU as configured. Devices are started once, to learn what the camera delivers.
[[nodiscard]] Result<LiveSources> open_sources(const Configuration& configuration);

/// What can be told of a live camera's lens without starting the camera.
[[nodiscard]] Result<void> check_lens(const CalibrationSettings& settings);

/// What is known of a camera that delivers `format`. A calibration for another size is scaled, if
/// it is for the same shape of picture.
[[nodiscard]] Result<CameraCalibration> calibration_for(const CameraFormat& format,
                                                        const CalibrationSettings& settings);

}  // namespace gimbal
