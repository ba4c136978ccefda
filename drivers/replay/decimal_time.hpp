#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

enum class TimeTextFault : std::uint8_t {
  not_a_number,
  not_finite,    ///< "nan" or "inf"
  out_of_range,  ///< beyond 146 years, so that any two times have a difference
};

/// What a log counts time in; the value is the power of ten of a second.
enum class TimeUnit : std::int8_t {
  seconds = 0,
  milliseconds = -3,
  microseconds = -6,
  nanoseconds = -9,
};

/// A time in decimal notation ("1627530745.150090", "-3e-2") to the nearest nanosecond. Exact: a
/// double would cut the stamps of a clock that counts from 1970 to 0.2 µs.
[[nodiscard]] tl::expected<SensorDuration, TimeTextFault> parse_time(std::string_view text,
                                                                     TimeUnit unit);

/// Seconds with nine decimals; `parse_time` gives back the same duration.
[[nodiscard]] std::string format_seconds(SensorDuration duration);

}  // namespace gimbal
