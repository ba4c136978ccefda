#pragma once

#include <functional>

#include "drivers/replay/session.hpp"
#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {

/// Hands every gyro sample of the recording on, with the accelerometer interpolated to it.
[[nodiscard]] Result<void> replay_samples(const Session& session,
                                          const std::function<void(const ImuSample&)>& take);

}  // namespace gimbal
