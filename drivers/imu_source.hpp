#pragma once

#include <optional>
#include <variant>

#include "pipeline/sample/imu_sample.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

using ImuReading = std::variant<GyroSample, AccelSample>;

/// Inertial samples in order of time; gyroscope and accelerometer may have rates of their own.
/// None is ever dropped silently.
class ImuSource {
 public:
  ImuSource() = default;
  ImuSource(const ImuSource&) = delete;
  ImuSource& operator=(const ImuSource&) = delete;
  virtual ~ImuSource() = default;

  /// Begins to deliver; a replay begins at its first sample again. Allowed after `stop`.
  [[nodiscard]] virtual Result<void> start() = 0;

  /// Waits for the next sample; nothing at the end of a recording or after `stop`.
  [[nodiscard]] virtual Result<std::optional<ImuReading>> read() = 0;

  virtual void stop() = 0;
};

}  // namespace gimbal
