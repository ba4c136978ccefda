#pragma once

#include <optional>

#include "drivers/v4l2/v4l2_device.hpp"
#include "pipeline/sample/sensor_time.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

struct SensorTiming {
  SensorDuration readout{};  ///< from the first row to one past the last
  double fps = 0;            ///< 0: the sensor does not tell its vertical blanking
};

/// From the controls of a sensor: a line has its width and HBLANK pixels, a frame its height and
/// VBLANK lines, PIXEL_RATE of them come in a second (driver-api/media/camera-sensor.rst). Nothing
/// where it has no such controls.
[[nodiscard]] std::optional<SensorTiming> read_sensor_timing(V4l2Device& device, ImageSize size);

/// What a sensor that is a device of its own sends, before anything crops or scales it.
[[nodiscard]] std::optional<ImageSize> sensor_size(V4l2Device& sensor);

}  // namespace gimbal
