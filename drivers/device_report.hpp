#pragma once

#include <string>
#include <vector>

namespace gimbal {

/// A device that a driver has found, for people to read.
struct DeviceReport {
  std::string driver;                ///< as the configuration names it, such as "v4l2"
  std::string address;               ///< as the configuration names it, such as "/dev/video0"
  std::string name;                  ///< as the device calls itself
  std::vector<std::string> details;  ///< formats, rates, clocks: one line each
  std::string obstacle;              ///< why it cannot be used, and what to do; empty if it can
};

}  // namespace gimbal
