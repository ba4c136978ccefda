#include "drivers/replay/replay_imu.hpp"

namespace gimbal {
namespace {

// The MPU-6050's register map has 1.9 to 4.8 ms for bandwidths of 188 to 42 Hz.
constexpr SensorDuration kUsualDelay = std::chrono::microseconds(2500);

SensorDuration delay_of(const Session& session) {
  // A camera's time offset was found against the samples' stamps, so that it holds the delay.
  const bool has_camera = session.camera || session.camera_without_lens;
  return session.imu.delay.value_or(has_camera ? SensorDuration::zero() : kUsualDelay);
}

}  // namespace

ReplayImu::ReplayImu(const Session& session) : gyro_(session.gyro), accel_(session.accel) {
  const SensorDuration delay = delay_of(session);
  for (GyroSample& sample : gyro_) sample.time -= delay;
  for (AccelSample& sample : accel_) sample.time -= delay;
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
