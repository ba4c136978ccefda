#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/estimator/attitude_ekf.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

using WallTime = std::chrono::sys_seconds;

/// What was known of a gyroscope's bias, and when.
struct KnownBias {
  std::string imu;  ///< which one: letters, digits, dots, dashes and underscores
  WallTime time;
  GyroBias bias;
};

/// Nothing if there is no such file. `bad_input` where it does not hold what write_bias_file
/// writes, or what no gyroscope has.
[[nodiscard]] Result<std::optional<KnownBias>> read_bias_file(const std::filesystem::path& path);

/// Durably: either the old text or the new one is there, whatever happens. Makes the folder.
[[nodiscard]] Result<void> write_bias_file(const std::filesystem::path& path,
                                           const KnownBias& known);

}  // namespace gimbal
