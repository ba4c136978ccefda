#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drivers/device_report.hpp"
#include "drivers/i2c/i2c_device.hpp"

namespace gimbal {

/// A chip by what its identity register reads.
struct ChipIdentity {
  std::uint8_t value;
  const char* name;
};

/// How a family of chips is recognized.
struct ChipFamily {
  const char* driver;  ///< as the configuration names it
  std::uint8_t identity_register;
  std::span<const ChipIdentity> members;
  std::span<const std::uint8_t> addresses;  ///< that a chip can be strapped to
};

/// The chip's name; `bad_input` if the register reads what no member does.
[[nodiscard]] Result<std::string> identify(I2cDevice& device, const ChipFamily& family);

/// The family's chips on all buses of this computer. Reads the identity register at the family's
/// addresses, where no kernel driver holds them.
[[nodiscard]] std::vector<DeviceReport> probe_buses(const ChipFamily& family);

}  // namespace gimbal
