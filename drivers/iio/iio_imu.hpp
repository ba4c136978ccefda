#pragma once

#include <memory>
#include <vector>

#include "drivers/device_report.hpp"
#include "drivers/iio/iio_imu_settings.hpp"
#include "drivers/imu_source.hpp"

namespace gimbal {

/// An IMU whose samples come from the kernel's IIO buffers, by libiio: one device with gyroscope
/// and accelerometer, or two. Scale, offset and mount matrix are applied, so samples come in the
/// board's axes as the device tree names them, which are the chip's own where it names none.
/// Devices are looked for anew by each `start`, so that one that was unplugged may come back under
/// another id. `bad_input` where none fits the settings now.
[[nodiscard]] Result<std::unique_ptr<ImuSource>> open_iio_imu(const IioImuSettings& settings);

/// Every IIO device with a gyroscope or an accelerometer, and what stands in its way.
[[nodiscard]] std::vector<DeviceReport> list_iio_imus();

}  // namespace gimbal
