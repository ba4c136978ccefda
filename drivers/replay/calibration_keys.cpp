#include "drivers/replay/calibration_keys.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>

namespace gimbal {
namespace {

constexpr double kLongestReadout_s = 10.0;
constexpr double kLongestImuDelay_s = 1.0;
/// Offsets between the epochs of two clocks can be decades; more does not fit.
constexpr double kLongestOffset_s = 4e9;

constexpr std::array<NamedValue<LensModel>, 3> kLensModels{{{"pinhole", LensModel::pinhole},
                                                            {"brown", LensModel::brown},
                                                            {"fisheye", LensModel::fisheye}}};
constexpr std::array<NamedValue<ReadoutDirection>, 4> kDirections{
    {{"top-down", ReadoutDirection::top_down},
     {"bottom-up", ReadoutDirection::bottom_up},
     {"left-right", ReadoutDirection::left_right},
     {"right-left", ReadoutDirection::right_left}}};
constexpr std::array<NamedValue<TimestampReference>, 3> kTimestamps{
    {{"readout-start", TimestampReference::readout_start},
     {"exposure-start", TimestampReference::exposure_start},
     {"readout-end", TimestampReference::readout_end}}};

}  // namespace

std::span<const NamedValue<LensModel>> lens_model_names() {
  return kLensModels;
}

std::span<const NamedValue<ReadoutDirection>> readout_direction_names() {
  return kDirections;
}

std::span<const NamedValue<TimestampReference>> timestamp_names() {
  return kTimestamps;
}

std::optional<SensorDuration> read_duration(TomlTable& table, std::string_view key, double least_s,
                                            double most_s) {
  const std::optional<double> seconds = table.number(key);
  if (!seconds) return std::nullopt;
  if (*seconds < least_s || *seconds > most_s) {
    table.refuse(key,
                 fmt::format("is {}; {} to {} seconds are allowed", *seconds, least_s, most_s));
    return std::nullopt;
  }
  return duration_from_seconds(*seconds);
}

std::optional<SensorDuration> read_readout(TomlTable& table) {
  return read_duration(table, "readout_s", 0, kLongestReadout_s);
}

std::optional<SensorDuration> read_time_offset(TomlTable& table) {
  return read_duration(table, "time_offset_s", -kLongestOffset_s, kLongestOffset_s);
}

std::optional<SensorDuration> read_imu_delay(TomlTable& table) {
  return read_duration(table, "delay_s", 0, kLongestImuDelay_s);
}

std::optional<Eigen::Matrix3d> read_rotation(TomlTable& table, std::string_view key) {
  constexpr double kRounding = 1e-2;
  constexpr double kExact = 1e-12;
  const std::optional<Eigen::Matrix3d> R = table.matrix3(key);
  if (!R) return std::nullopt;
  const double error = (R->transpose() * *R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (error > kRounding || R->determinant() < 0) {
    table.refuse(key, R->determinant() < 0
                          ? "is a mirror, not a rotation: its determinant is below 0"
                          : "is not a rotation: its rows are not unit vectors at "
                            "right angles to each other");
    return std::nullopt;
  }
  return error < kExact ? *R : Eigen::Quaterniond(*R).normalized().toRotationMatrix();
}

}  // namespace gimbal
