#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/camera_source.hpp"
#include "drivers/device_report.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

struct LibcameraSettings {
  /// Id or model, as `gimbalctl devices` shows them; empty for the first camera.
  std::string camera;
  std::optional<ImageSize> size;  ///< what libcamera proposes for video, if none
  std::optional<double> fps;      ///< what the camera does by itself, if none
  /// "NV12", "YUV420", "RGB888" or "BGR888", as libcamera calls them; "auto" takes the first of
  /// these that there is.
  std::string pixel_format = "auto";
  /// By name, as libcamera spells it, such as "ExposureTime"; several numbers where the control has
  /// several, such as "ColourGains".
  std::map<std::string, std::vector<double>> controls;
  /// Which instant the stamps name. libcamera calls it the start of the first row's exposure, while
  /// most pipelines pass on when the readout began: so unknown, if none.
  std::optional<TimestampReference> timestamp;
  /// Without a picture for so long the camera counts as lost.
  SensorDuration silence_limit = std::chrono::seconds(2);

  bool operator==(const LibcameraSettings&) const = default;
};

/// The camera is opened by `start`, anew each time. Only what is wrong with the settings themselves
/// fails here.
[[nodiscard]] Result<std::unique_ptr<CameraSource>> open_libcamera_camera(
    LibcameraSettings settings);

[[nodiscard]] std::vector<DeviceReport> list_libcamera_cameras();

}  // namespace gimbal
