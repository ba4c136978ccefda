#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <span>
#include <string_view>

#include "drivers/replay/toml_reader.hpp"
#include "pipeline/sample/calibration.hpp"

namespace gimbal {

// Keys of a calibration, as session.toml and the daemon's configuration have them.

[[nodiscard]] std::span<const NamedValue<LensModel>> lens_model_names();
[[nodiscard]] std::span<const NamedValue<ReadoutDirection>> readout_direction_names();
[[nodiscard]] std::span<const NamedValue<TimestampReference>> timestamp_names();

/// Precondition: the value has a name.
template <typename T>
std::string_view name_of(std::span<const NamedValue<T>> names, T value) {
  const auto found = std::find_if(names.begin(), names.end(),
                                  [&](const NamedValue<T>& named) { return named.value == value; });
  return found->name;
}

/// Nothing where the key is not there, or is refused.
[[nodiscard]] std::optional<SensorDuration> read_duration(TomlTable& table, std::string_view key,
                                                          double least_s, double most_s);

/// The seconds that a sensor may take from its first row to its last.
[[nodiscard]] std::optional<SensorDuration> read_readout(TomlTable& table);

/// What may be added to a frame's stamp to get the IMU's clock.
[[nodiscard]] std::optional<SensorDuration> read_time_offset(TomlTable& table);

/// How much later than it was true a sample may be stamped.
[[nodiscard]] std::optional<SensorDuration> read_imu_delay(TomlTable& table);

/// The rotation nearest to a matrix that was rounded when it was written.
[[nodiscard]] std::optional<Eigen::Matrix3d> read_rotation(TomlTable& table, std::string_view key);

}  // namespace gimbal
