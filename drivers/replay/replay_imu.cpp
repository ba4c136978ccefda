#include "drivers/replay/replay_imu.hpp"

namespace gimbal {

ReplayImu::ReplayImu(const Session& session) : gyro_(session.gyro), accel_(session.accel) {
  stop();
}

Result<void> ReplayImu::start() {
  next_gyro_ = 0;
  next_accel_ = 0;
  return {};
}

Result<std::optional<ImuReading>> ReplayImu::read() {
  const bool has_gyro = next_gyro_ < gyro_.size();
  const bool has_accel = next_accel_ < accel_.size();
  if (has_accel && (!has_gyro || accel_[next_accel_].time <= gyro_[next_gyro_].time)) {
    return std::optional<ImuReading>(accel_[next_accel_++]);
  }
  if (has_gyro) return std::optional<ImuReading>(gyro_[next_gyro_++]);
  return std::optional<ImuReading>();
}

void ReplayImu::stop() {
  next_gyro_ = gyro_.size();
  next_accel_ = accel_.size();
}

}  // namespace gimbal
