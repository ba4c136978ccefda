#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/iio/iio_imu_settings.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// An IIO device that measures angular rate or specific force, as far as the choice needs it.
struct IioCandidate {
  std::string id;     ///< "iio:device0"
  std::string name;   ///< of the chip or the driver; may be empty
  std::string label;  ///< from the device tree; may be empty
  bool has_gyro = false;
  bool has_accel = false;
  std::string obstacle = {};  ///< why its buffer cannot be used; empty if it can

  /// "iio:device0 (bmi160)"
  [[nodiscard]] std::string title() const;
};

/// Ids; both the same for a 6-axis device.
struct IioChoice {
  std::string gyro;
  std::optional<std::string> accel;  ///< absent only where the settings say "none"
};

/// Devices as the settings name them. "auto" takes a 6-axis device before a pair, and of the
/// accelerometers the one whose name goes with the gyroscope's ("lsm6dso_gyro", "lsm6dso_accel").
[[nodiscard]] Result<IioChoice> choose_devices(const std::vector<IioCandidate>& candidates,
                                               const IioImuSettings& settings);

}  // namespace gimbal
