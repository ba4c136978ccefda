#pragma once

#include "drivers/driver_table.hpp"
#include "drivers/replay/toml_reader.hpp"

namespace gimbal {

// The tables of the configuration that are named after drivers. Faults are kept in the table.

void read_v4l2(TomlTable& table, V4l2CameraSettings& settings);
void read_libcamera(TomlTable& table, LibcameraSettings& settings);
void read_iio(TomlTable& table, IioImuSettings& settings);
void read_i2c(TomlTable& table, ImuSettings& settings);

}  // namespace gimbal
