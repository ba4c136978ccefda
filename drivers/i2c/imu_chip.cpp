#include "drivers/i2c/imu_chip.hpp"

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

}  // namespace gimbal
