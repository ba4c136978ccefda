#pragma once

#include <iio.h>

#include <optional>

#include "drivers/iio/axes.hpp"
#include "drivers/iio/libiio.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Has the device stamp by CLOCK_MONOTONIC, and reads back that it does. A buffer that an ended
/// program left on is put off first.
[[nodiscard]] Result<void> set_monotonic_clock(const iio_device& device);

/// Sets the nearest rate at or above the wish; what it is now, in hertz, or nothing where only a
/// trigger sets the pace. A rate that may not be changed is kept if it is high enough.
[[nodiscard]] Result<std::optional<double>> set_rate(const iio_device& device, IioTriad triad,
                                                     double wish_hz);

/// Scale, offset and mount matrix of a sensor.
[[nodiscard]] Result<AxesScaling> read_scaling(const iio_device& device, IioTriad triad);

}  // namespace gimbal
