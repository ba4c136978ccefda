#pragma once

#include <cstddef>
#include <vector>

#include "drivers/imu_source.hpp"
#include "drivers/replay/session.hpp"

namespace gimbal {

/// The inertial samples of a recording, both sensors merged in order of time; of equal stamps the
/// accelerometer's comes first, so that it is known once the gyro's is. Each at the instant when it
/// was true: its stamp less the sensor's delay. Reads no clock.
class ReplayImu final : public ImuSource {
 public:
  /// Keeps a copy of the samples; the session may go.
  explicit ReplayImu(const Session& session);

  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<std::optional<ImuReading>> read() override;
  void stop() override;

 private:
  std::vector<GyroSample> gyro_;
  std::vector<AccelSample> accel_;
  std::size_t next_gyro_ = 0;
  std::size_t next_accel_ = 0;
};

}  // namespace gimbal
