#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "drivers/replay/session.hpp"
#include "pipeline/estimator/estimator.hpp"
#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {

enum class EstimatorKind : std::uint8_t { thesis };

[[nodiscard]] std::unique_ptr<Estimator> make_estimator(EstimatorKind kind);

/// Hands every sample of the recording on, the accelerometer interpolated to the gyro's stamps.
[[nodiscard]] Result<void> replay_samples(const Session& session,
                                          const std::function<void(const ImuSample&)>& take);

}  // namespace gimbal
