#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// What every driver of a real camera can be told.
struct LiveCameraSettings {
  std::optional<ImageSize> size;  ///< what the camera is set to, or its driver proposes, if none
  std::optional<double> fps;      ///< what the camera is set to, if none
  /// By the name that the driver's own tools have for it; "auto" leaves the choice to the driver.
  std::string pixel_format = "auto";
  /// Which instant the stamps name, where the driver's word on that is missing or wrong.
  std::optional<TimestampReference> timestamp;
  /// Without a picture for so long the camera counts as lost.
  SensorDuration silence_limit = std::chrono::seconds(2);

  bool operator==(const LiveCameraSettings&) const = default;
};

/// `bad_input` that names the driver, where a value makes no sense for any camera.
[[nodiscard]] Result<void> check_live_camera(std::string_view driver,
                                             const LiveCameraSettings& settings);

}  // namespace gimbal
