#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "drivers/camera_source.hpp"
#include "drivers/device_report.hpp"
#include "drivers/live_camera_settings.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Of the pixel formats "NV12", "YUV420", "RGB888" and "BGR888", as libcamera calls them, "auto"
/// takes the first that there is. libcamera calls its stamps the start of the first row's exposure,
/// while most pipelines pass on when the readout began: so what they name is unknown unless it is
/// set.
struct LibcameraSettings : LiveCameraSettings {
  /// Id or model, as `gimbalctl devices` shows them; empty for the first camera.
  std::string camera;
  /// By name, as libcamera spells it, such as "ExposureTime"; several numbers where the control has
  /// several, such as "ColourGains".
  std::map<std::string, std::vector<double>> controls;

  bool operator==(const LibcameraSettings&) const = default;
};

/// The camera is opened by `start`, anew each time. Only what is wrong with the settings themselves
/// fails here.
[[nodiscard]] Result<std::unique_ptr<CameraSource>> open_libcamera_camera(
    LibcameraSettings settings);

[[nodiscard]] std::vector<DeviceReport> list_libcamera_cameras();

}  // namespace gimbal
