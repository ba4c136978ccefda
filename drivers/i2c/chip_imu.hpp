#pragma once

#include <memory>

#include "drivers/edge_source.hpp"
#include "drivers/i2c/i2c_imu_settings.hpp"
#include "drivers/i2c/imu_chip.hpp"
#include "drivers/imu_source.hpp"

namespace gimbal {

/// A chip on an I²C bus as a source of samples. `data_ready`: rising edges of its interrupt line,
/// where that is connected; may be null. Samples then take the edges' stamps; without, a FIFO's are
/// reconstructed (FifoClock), and polled ones are taken to be half a period old.
[[nodiscard]] std::unique_ptr<ImuSource> make_chip_imu(std::unique_ptr<ImuChip> chip,
                                                       const I2cImuSettings& settings,
                                                       std::unique_ptr<EdgeSource> data_ready);

/// What is wrong with settings, whatever the chip.
[[nodiscard]] Result<void> check_settings(const I2cImuSettings& settings);

}  // namespace gimbal
