#pragma once

#include <memory>
#include <vector>

#include "drivers/device_report.hpp"
#include "drivers/edge_source.hpp"
#include "drivers/i2c/i2c_imu_settings.hpp"
#include "drivers/i2c/imu_chip.hpp"
#include "drivers/imu_source.hpp"

namespace gimbal {

/// ICM-42688-P over I²C. `data_ready`: rising edges of the chip's interrupt line, or
/// null. The chip is configured by `start`.
[[nodiscard]] Result<std::unique_ptr<ImuSource>> open_i2c_icm42688(
    const I2cImuSettings& settings, std::unique_ptr<EdgeSource> data_ready = nullptr);

/// Those that answer on this computer's buses.
[[nodiscard]] std::vector<DeviceReport> list_i2c_icm42688();

/// The chip alone, on any bus.
[[nodiscard]] std::unique_ptr<ImuChip> make_icm42688(std::unique_ptr<I2cDevice> device,
                                                     const I2cImuSettings& settings);

}  // namespace gimbal
