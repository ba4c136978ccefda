#pragma once

#include <chrono>
#include <cstdint>

namespace gimbal {

/// The one clock of the pipeline: CLOCK_MONOTONIC, or in a replay the clock that the recording's
/// stamps share. It has no now() on purpose: only a live driver reads a clock.
struct MonotonicClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<MonotonicClock>;
  static constexpr bool is_steady = true;
};

using SensorTime = MonotonicClock::time_point;
using SensorDuration = MonotonicClock::duration;

/// Seconds as a double, for arithmetic on differences. A double holds an epoch time to 0.2 µs only.
constexpr double to_seconds(SensorDuration duration) {
  return std::chrono::duration<double>(duration).count();
}

/// Nearest nanosecond. Undefined for values that do not fit (beyond 292 years) or are not finite.
constexpr SensorDuration duration_from_seconds(double seconds) {
  const double nanoseconds = seconds * 1e9;
  return SensorDuration(static_cast<std::int64_t>(nanoseconds + (nanoseconds < 0 ? -0.5 : 0.5)));
}

/// The instant `seconds` after the clock's epoch.
constexpr SensorTime time_from_seconds(double seconds) {
  return SensorTime(duration_from_seconds(seconds));
}

/// Seconds since the clock's epoch, as the `t_s` columns of logs have it.
constexpr double seconds_since_epoch(SensorTime time) {
  return to_seconds(time.time_since_epoch());
}

}  // namespace gimbal
