#include "drivers/i2c/open_chip.hpp"

#include <utility>

#include "drivers/i2c/chip_imu.hpp"

namespace gimbal {

Result<std::unique_ptr<ImuSource>> open_chip(const ChipFamily& family, ChipMaker make,
                                             const I2cImuSettings& settings,
                                             std::unique_ptr<EdgeSource> data_ready) {
  if (auto good = check_settings(settings); !good) return tl::unexpected(good.error());
  auto device = open_i2c_device(settings.address);
  if (!device) return tl::unexpected(device.error());
  if (const auto name = identify(**device, family); !name) return tl::unexpected(name.error());
  return make_chip_imu(make(*std::move(device), settings), settings, std::move(data_ready));
}

}  // namespace gimbal
