#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// A clock that a driver may have stamped with, whatever it says. `system_counter` is the
/// generic timer of ARM since power-on, which NVIDIA's capture engines stamp with.
enum class KernelClock : std::uint8_t {
  monotonic,
  boottime,
  monotonic_raw,
  realtime,
  tai,
  system_counter,
};

/// What a clock says now; nothing where there is no such clock.
[[nodiscard]] std::optional<SensorDuration> read_kernel_clock(KernelClock clock);

using ReadClock = std::function<std::optional<SensorDuration>(KernelClock)>;

/// "CLOCK_MONOTONIC" and so on.
[[nodiscard]] std::string name_of(KernelClock clock);

/// The clock by which a stamp is a picture's that has just arrived, CLOCK_MONOTONIC before all
/// others; nothing if it is none of them. What the driver says is only a claim: NVIDIA's vi5 stamps
/// by the system counter and says CLOCK_MONOTONIC, and drivers of loopback devices say nothing.
[[nodiscard]] std::optional<KernelClock> find_clock(SensorDuration stamp, const ReadClock& now);

/// A stamp by some clock, on CLOCK_MONOTONIC. Both clocks are read anew for each stamp, so that one
/// that is slewed or set does not drift away.
[[nodiscard]] SensorTime to_monotonic(SensorDuration stamp, KernelClock clock,
                                      const ReadClock& now);

}  // namespace gimbal
