#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/i2c/i2c_imu_settings.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// What a chip measured at one instant, in its own axes.
struct ChipReading {
  Eigen::Vector3d gyro_rad_s;
  std::optional<Eigen::Vector3d> accel_m_s2;
};

/// How much waits in a chip's FIFO.
struct FifoLevel {
  std::size_t samples = 0;
  bool has_overflowed = false;
};

/// A chip as the driver needs it: what differs from chip to chip, and nothing of time or threads.
class ImuChip {
 public:
  ImuChip() = default;
  ImuChip(const ImuChip&) = delete;
  ImuChip& operator=(const ImuChip&) = delete;
  virtual ~ImuChip() = default;

  [[nodiscard]] virtual std::string title() const = 0;

  /// Checks that it is the chip, resets it, sets ranges, rate and filter, and lets it sample.
  [[nodiscard]] virtual Result<void> configure() = 0;

  /// Between two samples, by the data sheet.
  [[nodiscard]] virtual SensorDuration nominal_period() const = 0;

  [[nodiscard]] virtual Result<FifoLevel> fifo_level() = 0;

  /// The oldest `samples`; nothing in the place of one that the chip marked as invalid. An error
  /// means that what is in the FIFO can no longer be told apart.
  [[nodiscard]] virtual Result<std::vector<std::optional<ChipReading>>> read_fifo(
      std::size_t samples) = 0;

  /// Empties the FIFO and lets it fill again.
  [[nodiscard]] virtual Result<void> restart_fifo() = 0;

  /// From the data registers.
  [[nodiscard]] virtual Result<ChipReading> read_latest() = 0;
};

/// Three numbers of 16 bits, each with its high byte first, or last.
[[nodiscard]] Eigen::Vector3d big_endian_axes(const std::uint8_t* bytes);
[[nodiscard]] Eigen::Vector3d little_endian_axes(const std::uint8_t* bytes);

/// A chip's numbers where the whole of 16 bits is the range that was set, high byte first.
[[nodiscard]] ChipReading full_scale_reading(const I2cImuSettings& settings,
                                             const std::uint8_t* accel, const std::uint8_t* gyro);

/// Radians per second from degrees per second.
inline constexpr double kRadiansPerDegree = 0.017453292519943295;

}  // namespace gimbal
