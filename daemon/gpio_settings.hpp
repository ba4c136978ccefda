#pragma once

#include <string>

#include "drivers/gpio/gpio_lines.hpp"

namespace gimbal {

/// The table [gpio]: lines that a person sees and presses.
struct GpioSettings {
  std::string record_button;  ///< "gpiochip0:17"; empty for none
  GpioPolarity record_button_polarity = GpioPolarity::active_low;
  std::string status_led;
  GpioPolarity status_led_polarity = GpioPolarity::active_high;

  bool operator==(const GpioSettings&) const = default;
};

}  // namespace gimbal
