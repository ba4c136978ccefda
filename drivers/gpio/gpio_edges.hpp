#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "drivers/device_report.hpp"
#include "drivers/edge_source.hpp"
#include "drivers/gpio/gpio_lines.hpp"

namespace gimbal {

/// Edges of a line with the kernel's stamps. With libgpiod 2.x lost edges are counted; with 1.x
/// they cannot be seen, and a kernel before 5.7, which stamps by CLOCK_REALTIME, is refused at the
/// first edge. The line is requested by `start`.
[[nodiscard]] std::unique_ptr<EdgeSource> open_gpio_edges(const GpioInputSettings& settings);

/// How a line is requested; a test may stand in for a chip.
using GpioInputOpener = std::function<Result<std::unique_ptr<GpioInput>>(const GpioInputSettings&)>;
[[nodiscard]] std::unique_ptr<EdgeSource> open_gpio_edges(const GpioInputSettings& settings,
                                                          GpioInputOpener opener);

/// Every GPIO chip, with its lines that have names.
[[nodiscard]] std::vector<DeviceReport> list_gpio_chips();

}  // namespace gimbal
