#include "drivers/v4l2/sensor_timing.hpp"

#include <linux/v4l2-subdev.h>

#include "drivers/v4l2/controls.hpp"

namespace gimbal {

std::optional<SensorTiming> read_sensor_timing(V4l2Device& device, ImageSize size) {
  const auto pixel_rate_hz = get_control(device, V4L2_CID_PIXEL_RATE);
  const auto blank_px = get_control(device, V4L2_CID_HBLANK);
  if (!pixel_rate_hz || !blank_px || *pixel_rate_hz <= 0) return std::nullopt;
  const double line_s =
      static_cast<double>(size.width + *blank_px) / static_cast<double>(*pixel_rate_hz);
  SensorTiming timing{duration_from_seconds(line_s * size.height), 0};
  if (const auto blank_lines = get_control(device, V4L2_CID_VBLANK)) {
    timing.fps = 1 / (line_s * static_cast<double>(size.height + *blank_lines));
  }
  return timing;
}

std::optional<ImageSize> sensor_size(V4l2Device& sensor) {
  v4l2_subdev_format format{};
  format.which = V4L2_SUBDEV_FORMAT_ACTIVE;
  if (sensor.request(VIDIOC_SUBDEV_G_FMT, &format) != 0) return std::nullopt;
  return ImageSize{static_cast<int>(format.format.width), static_cast<int>(format.format.height)};
}

}  // namespace gimbal
