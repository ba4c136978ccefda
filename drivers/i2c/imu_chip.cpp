#include "drivers/i2c/imu_chip.hpp"

#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {
namespace {

double number(unsigned high, unsigned low) {
  return static_cast<std::int16_t>(high << 8U | low);
}

}  // namespace

Eigen::Vector3d big_endian_axes(const std::uint8_t* bytes) {
  return {number(bytes[0], bytes[1]), number(bytes[2], bytes[3]), number(bytes[4], bytes[5])};
}

Eigen::Vector3d little_endian_axes(const std::uint8_t* bytes) {
  return {number(bytes[1], bytes[0]), number(bytes[3], bytes[2]), number(bytes[5], bytes[4])};
}

ChipReading full_scale_reading(const I2cImuSettings& settings, const std::uint8_t* accel,
                               const std::uint8_t* gyro) {
  const double full_dps = settings.gyro_range == GyroRange::dps_2000 ? 2000 : 1000;
  const double full_g = settings.accel_range == AccelRange::g_16 ? 16 : 8;
  return {big_endian_axes(gyro) * (full_dps / 32768 * kRadiansPerDegree),
          big_endian_axes(accel) * (full_g / 32768 * kStandardGravity_m_s2)};
}

}  // namespace gimbal
