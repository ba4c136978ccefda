#pragma once

#include <chrono>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// What CLOCK_MONOTONIC says: it is libstdc++'s steady clock.
[[nodiscard]] inline SensorTime monotonic_now() {
  return SensorTime(std::chrono::duration_cast<SensorDuration>(
      std::chrono::steady_clock::now().time_since_epoch()));
}

}  // namespace gimbal
