#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/camera_source.hpp"
#include "drivers/device_report.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Where a frame's time comes from.
enum class StampSource : std::uint8_t {
  device,   ///< the driver's stamp, on whatever clock of the kernel it turns out to be
  arrival,  ///< when the picture was there to be read: late by readout and transfer, and jittering
};

struct V4l2CameraSettings {
  /// "/dev/video0", a link such as "/dev/v4l/by-id/...", or the name or bus of a camera as
  /// `gimbalctl devices` shows them; empty for the first that delivers pictures.
  std::string device;
  std::optional<ImageSize> size;  ///< what the device is set to, if none
  std::optional<double> fps;      ///< what the device is set to, if none
  /// "NV12", "NM12", "YU12", "YV12", "YUYV", "UYVY", "MJPG" or "GREY"; "auto" takes, of those that
  /// reach the size and rate, the one that is least work.
  std::string pixel_format = "auto";
  /// By name, as `v4l2-ctl --list-ctrls` spells it.
  std::map<std::string, std::int64_t> controls;
  /// Which instant the stamps name, where the driver's word on that is wrong.
  std::optional<TimestampReference> timestamp;
  StampSource stamp_source = StampSource::device;
  /// Without a picture for so long the camera counts as lost.
  SensorDuration silence_limit = std::chrono::seconds(2);
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
