#pragma once

#include <memory>

#include "drivers/edge_source.hpp"
#include "drivers/i2c/i2c_device.hpp"
#include "drivers/i2c/i2c_imu_settings.hpp"
#include "drivers/i2c/imu_chip.hpp"
#include "drivers/i2c/probe.hpp"
#include "drivers/imu_source.hpp"

namespace gimbal {

/// Makes a family's chip on a device.
using ChipMaker = std::unique_ptr<ImuChip> (*)(std::unique_ptr<I2cDevice> device,
                                               const I2cImuSettings& settings);

/// The chip at the settings' address as a source of samples; `bad_input` where it is not of the
/// family. `data_ready`: see `make_chip_imu`.
[[nodiscard]] Result<std::unique_ptr<ImuSource>> open_chip(const ChipFamily& family, ChipMaker make,
                                                           const I2cImuSettings& settings,
                                                           std::unique_ptr<EdgeSource> data_ready);

}  // namespace gimbal
