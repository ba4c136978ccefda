#pragma once

#include <chrono>
#include <cstdint>

#include "drivers/i2c/i2c_device.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

enum class GyroRange : std::uint8_t { dps_1000, dps_2000 };
enum class AccelRange : std::uint8_t { g_8, g_16 };

/// How samples come from a chip.
enum class SampleDelivery : std::uint8_t {
  fifo,     ///< through the chip's FIFO: none is missed, stamps to 0.1 ms
  polling,  ///< from its data registers at the rate: for buses that are slow or emulated
};

/// How an IMU is used that gimbald itself drives over I²C.
struct I2cImuSettings {
  I2cAddress address;
  /// The nearest rate that the chip offers at or above this is set.
  double rate_hz = 500;
  GyroRange gyro_range = GyroRange::dps_2000;
  AccelRange accel_range = AccelRange::g_16;
  /// A FIFO that stays empty falls back to polling.
  SampleDelivery delivery = SampleDelivery::fifo;
  /// How often the FIFO is emptied.
  SensorDuration drain_period = std::chrono::milliseconds(5);
  /// How long the chip may deliver nothing until that is an error.
  SensorDuration silence_limit = std::chrono::seconds(1);

  bool operator==(const I2cImuSettings&) const = default;
};

}  // namespace gimbal
