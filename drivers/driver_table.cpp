#include "drivers/driver_table.hpp"

#include <fmt/format.h>

#include <iterator>
#include <utility>

#ifdef GIMBALD_HAS_GPIO
#include "drivers/gpio/gpio_edges.hpp"
#endif
#include "drivers/i2c_icm42688/icm42688.hpp"
#include "drivers/i2c_lsm6dso/lsm6dso.hpp"
#include "drivers/i2c_mpu6500/mpu6500.hpp"
#ifdef GIMBALD_HAS_IIO
#include "drivers/iio/iio_imu.hpp"
#endif

namespace gimbal {
namespace {

[[maybe_unused]] auto left_out(std::string_view driver) {
  return bad_input(fmt::format(
      "driver \"{}\": this gimbald was built without it, since its library was not there", driver));
}

void append(std::vector<DeviceReport>& all, std::vector<DeviceReport> some) {
  all.insert(all.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
}

Result<std::unique_ptr<CameraSource>> open_v4l2(
    [[maybe_unused]] const V4l2CameraSettings& settings) {
#ifdef GIMBALD_HAS_V4L2
  return open_v4l2_camera(settings);
#else
  return left_out("v4l2");
#endif
}

Result<std::unique_ptr<CameraSource>> open_libcamera(
    [[maybe_unused]] const LibcameraSettings& settings) {
#ifdef GIMBALD_HAS_LIBCAMERA
  return open_libcamera_camera(settings);
#else
  return left_out("libcamera");
#endif
}

Result<std::unique_ptr<ImuSource>> open_iio([[maybe_unused]] const IioImuSettings& settings) {
#ifdef GIMBALD_HAS_IIO
  return open_iio_imu(settings);
#else
  return left_out("iio");
#endif
}

/// With the chip's address select pin low, as most boards have it.
I2cImuSettings with_usual_address(ImuDriver driver, I2cImuSettings settings) {
  constexpr std::uint8_t kUsual = 0x68;
  constexpr std::uint8_t kUsualOfLsm6dso = 0x6a;
  if (settings.address.chip != 0) return settings;
  settings.address.chip = driver == ImuDriver::i2c_lsm6dso ? kUsualOfLsm6dso : kUsual;
  return settings;
}

/// Null where no line is named.
Result<std::unique_ptr<EdgeSource>> open_data_ready(const std::string& line) {
  if (line.empty()) return nullptr;
#ifdef GIMBALD_HAS_GPIO
  const auto address = parse_gpio_address(line);
  if (!address) return tl::unexpected(address.error());
  GpioInputSettings settings;
  settings.address = *address;
  settings.edges = GpioEdges::rising;
  return open_gpio_edges(settings);
#else
  return left_out("gpio");
#endif
}

}  // namespace

Result<std::unique_ptr<CameraSource>> open_camera(const CameraSettings& settings) {
  if (settings.driver == CameraDriver::libcamera) return open_libcamera(settings.libcamera);
  return open_v4l2(settings.v4l2);
}

Result<std::unique_ptr<ImuSource>> open_imu(const ImuSettings& settings) {
  if (settings.driver == ImuDriver::iio) return open_iio(settings.iio);
  auto data_ready = open_data_ready(settings.data_ready);
  if (!data_ready) return tl::unexpected(data_ready.error());
  const I2cImuSettings i2c = with_usual_address(settings.driver, settings.i2c);
  switch (settings.driver) {
    case ImuDriver::i2c_lsm6dso:
      return open_i2c_lsm6dso(i2c, std::move(*data_ready));
    case ImuDriver::i2c_icm42688:
      return open_i2c_icm42688(i2c, std::move(*data_ready));
    default:
      return open_i2c_mpu6500(i2c, std::move(*data_ready));
  }
}

std::vector<DeviceReport> list_devices() {
  std::vector<DeviceReport> all;
#ifdef GIMBALD_HAS_V4L2
  append(all, list_v4l2_cameras());
#endif
#ifdef GIMBALD_HAS_LIBCAMERA
  append(all, list_libcamera_cameras());
#endif
#ifdef GIMBALD_HAS_IIO
  append(all, list_iio_imus());
#endif
  append(all, list_i2c_mpu6500());
  append(all, list_i2c_lsm6dso());
  append(all, list_i2c_icm42688());
#ifdef GIMBALD_HAS_GPIO
  append(all, list_gpio_chips());
#endif
  return all;
}

std::vector<std::string_view> drivers_left_out() {
  return {
#ifndef GIMBALD_HAS_GPIO
      "gpio",
#endif
#ifndef GIMBALD_HAS_IIO
      "iio",
#endif
#ifndef GIMBALD_HAS_LIBCAMERA
      "libcamera",
#endif
#ifndef GIMBALD_HAS_V4L2
      "v4l2",
#endif
  };
}

}  // namespace gimbal
