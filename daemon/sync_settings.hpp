#pragma once

#include <optional>

namespace gimbal {

/// How the daemon keeps camera and IMU on the same clock.
struct SyncSettings {
  std::optional<bool> online;  ///< none: where the lens is calibrated
  double cpu_share = 0.05;     ///< of one core, at most

  bool operator==(const SyncSettings&) const = default;
};

}  // namespace gimbal
