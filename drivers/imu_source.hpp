#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pipeline/sample/imu_sample.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

using ImuReading = std::variant<GyroSample, AccelSample>;

/// Inertial samples in order of time; gyroscope and accelerometer may have rates of their own.
/// None is ever dropped silently. One thread starts, reads and asks; `stop` may come from another,
/// and ends a `read` that waits.
class ImuSource {
 public:
  ImuSource() = default;
  ImuSource(const ImuSource&) = delete;
  ImuSource& operator=(const ImuSource&) = delete;
  virtual ~ImuSource() = default;

  /// Begins to deliver; a replay begins at its first sample again. Allowed after `stop`.
  [[nodiscard]] virtual Result<void> start() = 0;

  /// Waits for the next sample; nothing at the end of a recording or after `stop`. Fails within a
  /// few seconds when the device is gone or has fallen silent; `start` may bring it back.
  [[nodiscard]] virtual Result<std::optional<ImuReading>> read() = 0;

  virtual void stop() = 0;

  /// Samples that the device took and that did not come out of `read`, since `start`.
  [[nodiscard]] virtual std::uint64_t lost() const { return 0; }

  /// What a person should know of how it runs since `start`, one line each, such as stamps that
  /// jumped. Bounded.
  [[nodiscard]] virtual std::vector<std::string> remarks() const { return {}; }
};

}  // namespace gimbal
