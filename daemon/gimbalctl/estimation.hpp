#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "drivers/replay/session.hpp"
#include "pipeline/sample/imu_sample.hpp"
#include "pipeline/smoother/attitude_stream.hpp"

namespace gimbal {

enum class EstimatorKind : std::uint8_t { ekf, thesis };

/// How much of the future an orientation may use.
struct Lookahead {
  static Lookahead nothing() { return {std::chrono::seconds(0)}; }
  static Lookahead everything() { return {std::nullopt}; }

  std::optional<SensorDuration> lag;  ///< none: the whole recording
};

/// For `--estimator`.
[[nodiscard]] const std::map<std::string, EstimatorKind>& estimator_names();

/// The thesis' filter never looks ahead, whatever it is allowed.
[[nodiscard]] std::unique_ptr<AttitudeStream> make_attitudes(EstimatorKind kind,
                                                             const Lookahead& lookahead);

/// Hands every gyro sample of the recording on, with the accelerometer interpolated to it.
[[nodiscard]] Result<void> replay_samples(const Session& session,
                                          const std::function<void(const ImuSample&)>& take);

}  // namespace gimbal
