#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/camera_source.hpp"
#include "drivers/device_report.hpp"
#include "drivers/i2c/i2c_imu_settings.hpp"
#include "drivers/iio/iio_imu_settings.hpp"
#include "drivers/imu_source.hpp"
#include "drivers/libcamera/libcamera_camera.hpp"
#include "drivers/v4l2/v4l2_camera.hpp"

namespace gimbal {

/// Cameras that are devices of this computer.
enum class CameraDriver : std::uint8_t { v4l2, libcamera };

/// IMUs that are devices of this computer.
enum class ImuDriver : std::uint8_t { iio, i2c_mpu6500, i2c_lsm6dso, i2c_icm42688 };

/// The settings of every driver, of which one is used.
struct CameraSettings {
  CameraDriver driver = CameraDriver::v4l2;
  V4l2CameraSettings v4l2;
  LibcameraSettings libcamera;

  bool operator==(const CameraSettings&) const = default;
};

struct ImuSettings {
  ImuDriver driver = ImuDriver::iio;
  IioImuSettings iio;
  I2cImuSettings i2c;  ///< of whichever chip the driver is for; an address of 0 is its usual one
  std::string data_ready;  ///< the line of the chip's interrupt, as "gpiochip0:17"; empty for none

  bool operator==(const ImuSettings&) const = default;
};

/// `bad_input` where the settings cannot be met, or where the driver's library was not there when
/// this program was built.
[[nodiscard]] Result<std::unique_ptr<CameraSource>> open_camera(const CameraSettings& settings);
[[nodiscard]] Result<std::unique_ptr<ImuSource>> open_imu(const ImuSettings& settings);

/// Everything that any driver sees.
[[nodiscard]] std::vector<DeviceReport> list_devices();

/// The drivers that were left out when this program was built.
[[nodiscard]] std::vector<std::string_view> drivers_left_out();

}  // namespace gimbal
