#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "daemon/bias_file.hpp"
#include "daemon/configuration.hpp"
#include "pipeline/estimator/attitude_ekf.hpp"

namespace gimbal {

/// Keeps a gyroscope's bias from one run to the next, so that the first seconds are as good as the
/// rest. What goes wrong is a line in the log: the bias is then learned anew.
class BiasMemory {
 public:
  /// `file`: empty for no memory. `imu`: which one, see KnownBias; another's bias is of no use.
  BiasMemory(std::filesystem::path file, std::chrono::seconds longest_age, std::string imu);

  /// What an earlier run knew, if that is not too long ago.
  [[nodiscard]] std::optional<GyroBias> recall(WallTime now) const;

  /// To be called often: writes every few minutes what there is to write.
  void keep(const std::optional<GyroBias>& bias, WallTime now);

  /// Writes now, at the end of a run.
  void keep_last(const std::optional<GyroBias>& bias, WallTime now);

 private:
  void write(const GyroBias& bias, WallTime now);

  std::filesystem::path file_;
  std::chrono::seconds longest_age_;
  std::string imu_;
  std::optional<WallTime> last_written_;
  bool has_complained_ = false;
};

/// Where the configuration says; a device's is kept even if it says nothing.
[[nodiscard]] BiasMemory bias_memory_for(const Configuration& configuration);

}  // namespace gimbal
