#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "drivers/camera_source.hpp"
#include "drivers/device_report.hpp"
#include "drivers/live_camera_settings.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Where a frame's time comes from.
enum class StampSource : std::uint8_t {
  device,   ///< the driver's stamp, on whatever clock of the kernel it turns out to be
  arrival,  ///< when the picture was there to be read: late by readout and transfer, and jittering
};

/// Of the pixel formats "NV12", "NM12", "YU12", "YV12", "YUYV", "UYVY", "MJPG" and "GREY", "auto"
/// takes the one that is least work, of those that reach the size and rate.
struct V4l2CameraSettings : LiveCameraSettings {
  /// "/dev/video0", a link such as "/dev/v4l/by-id/...", or the name or bus of a camera as
  /// `gimbalctl devices` shows them; empty for the first that delivers pictures.
  std::string device;
  /// By name, as `v4l2-ctl --list-ctrls` spells it.
  std::map<std::string, std::int64_t> controls;
  StampSource stamp_source = StampSource::device;
  /// Pictures that the device may fill, 2 to 32. Those that the pipeline holds are among them; when
  /// it holds too many, frames are copied.
  int buffers = 8;

  bool operator==(const V4l2CameraSettings&) const = default;
};

/// The device is opened by `start`, anew each time, so that one that was unplugged can come back
/// under another number. Only what is wrong with the settings themselves fails here.
[[nodiscard]] Result<std::unique_ptr<CameraSource>> open_v4l2_camera(V4l2CameraSettings settings);

/// All video nodes, those that cannot be used with the obstacle.
[[nodiscard]] std::vector<DeviceReport> list_v4l2_cameras();

}  // namespace gimbal
