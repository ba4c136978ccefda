#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/iio/axes.hpp"
#include "drivers/iio/libiio.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// What one device measured at one instant, in SI units and board axes.
struct IioScan {
  SensorTime stamp;
  std::optional<Eigen::Vector3d> gyro_rad_s;
  std::optional<Eigen::Vector3d> accel_m_s2;
};

/// One device's buffer, running. The device must outlive it.
class IioStream {
 public:
  /// Enables the channels of the sensors that are wanted, and the buffer.
  [[nodiscard]] static Result<IioStream> open(const iio_device& device,
                                              const std::vector<IioTriad>& sensors,
                                              unsigned buffer_length);

  /// Readable when there are samples.
  [[nodiscard]] int fd() const { return fd_; }

  /// What the kernel holds, without waiting. Fails when the device is gone.
  [[nodiscard]] Result<std::vector<IioScan>> drain();

 private:
  struct Sensor {
    IioTriad triad{};
    AxesScaling scaling;
  };

  explicit IioStream(const iio_device& device) : device_(&device) {}

  [[nodiscard]] Result<void> enable(const std::vector<IioTriad>& sensors);
  [[nodiscard]] Result<void> start(unsigned buffer_length);
  void decode(std::vector<IioScan>& scans) const;
  [[nodiscard]] Eigen::Vector3d read_axes(const Sensor& sensor, std::ptrdiff_t offset) const;
  [[nodiscard]] std::int64_t read_raw(const iio_channel& channel, std::ptrdiff_t offset) const;

  const iio_device* device_;
  std::vector<Sensor> sensors_;
  IioBuffer buffer_;
  int fd_ = -1;
};

}  // namespace gimbal
