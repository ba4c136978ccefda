#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// A sensor hub with a 3-axis accelerometer and a 3-axis gyroscope, as the kernel sees one that is
/// plugged in (Documentation/hid/uhid.rst, Documentation/hid/hid-sensor.rst). hid-sensor-accel-3d
/// and hid-sensor-gyro-3d make two IIO devices of it, "accel_3d" and "gyro_3d". Unplugged when
/// destroyed.
class HidSensorHub {
 public:
  /// Fails where /dev/uhid cannot be opened. `interval`: what the sensors say their period is.
  [[nodiscard]] static Result<HidSensorHub> plug_in(SensorDuration interval);

  HidSensorHub(HidSensorHub&& other) noexcept;
  HidSensorHub& operator=(HidSensorHub&&) = delete;
  ~HidSensorHub();

  /// When a sample was taken, as the hub says; with none the kernel stamps it as it arrives.
  using Stamp = std::optional<SensorTime>;

  [[nodiscard]] Result<void> send_gyro(const Eigen::Vector3d& gyro_rad_s, Stamp stamp);
  [[nodiscard]] Result<void> send_accel(const Eigen::Vector3d& accel_m_s2, Stamp stamp);

  /// Answers what the kernel asks, until an instant on CLOCK_MONOTONIC.
  [[nodiscard]] Result<void> answer_until(SensorTime end);

 private:
  enum class Sensor : std::uint8_t { accel = 1, gyro = 2 };  ///< also the number of its reports
  /// What the kernel may read and set: reporting state, power state, interval in ms (4 bytes).
  using Feature = std::array<std::uint8_t, 6>;
  /// Three axes of 4 bytes and a stamp of 8 (µs, 0 for none).
  using Input = std::array<std::uint8_t, 20>;

  HidSensorHub(int fd, SensorDuration interval);

  [[nodiscard]] Result<void> send(Sensor sensor, const Eigen::Vector3d& value, int exponent,
                                  Stamp stamp);
  [[nodiscard]] Result<void> answer_one();

  int fd_;
  std::array<Feature, 3> features_{};  ///< by number of report; [0] is none's
  std::array<Input, 3> inputs_{};      ///< what was sent last
};

}  // namespace gimbal
