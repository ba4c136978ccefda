#include "drivers/live_camera_settings.hpp"

#include <fmt/format.h>

namespace gimbal {

Result<void> check_live_camera(std::string_view driver, const LiveCameraSettings& settings) {
  constexpr double kFastest_hz = 1000;
  if (settings.size && (settings.size->width <= 0 || settings.size->height <= 0)) {
    return bad_input(fmt::format("{}: size {}x{} has to be positive", driver, settings.size->width,
                                 settings.size->height));
  }
  if (settings.fps && !(*settings.fps > 0 && *settings.fps <= kFastest_hz)) {
    return bad_input(fmt::format("{}: fps is {}, and has to be above 0 and at most {}", driver,
                                 *settings.fps, kFastest_hz));
  }
  if (settings.silence_limit <= SensorDuration::zero()) {
    return bad_input(fmt::format("{}: the silence limit has to be positive", driver));
  }
  return {};
}

}  // namespace gimbal
