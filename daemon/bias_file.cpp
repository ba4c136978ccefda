#include "daemon/bias_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <system_error>
#include <vector>

#include "daemon/durable_file.hpp"
#include "drivers/replay/toml_reader.hpp"

namespace gimbal {
namespace {

// Beyond what sensors have, by far: such a file was not written by us.
constexpr double kLargestBias_rad_s = 30 * std::numbers::pi / 180;
constexpr double kLargestSigma_rad_s = kLargestBias_rad_s;

std::optional<Eigen::Vector3d> read_axes(TomlTable& table, std::string_view key) {
  const auto numbers = table.numbers(key);
  if (!numbers) return std::nullopt;
  if (numbers->size() != 3) {
    table.refuse(key, "must be three numbers");
    return std::nullopt;
  }
  return Eigen::Vector3d(numbers->data());
}

/// Far from where differences would overflow.
bool is_possible(WallTime time) {
  constexpr std::chrono::years kMost{1000};
  return time >= WallTime() && time <= WallTime() + kMost;
}

/// NaN is within no limit.
bool is_possible(const GyroBias& bias) {
  return (bias.bias_rad_s.array().abs() <= kLargestBias_rad_s).all() &&
         (bias.sigma_rad_s.array() > 0).all() &&
         (bias.sigma_rad_s.array() <= kLargestSigma_rad_s).all();
}

std::string text_of(const Eigen::Vector3d& v) {
  return fmt::format("[{:#.9g}, {:#.9g}, {:#.9g}]", v.x(), v.y(), v.z());
}

}  // namespace

Result<std::optional<KnownBias>> read_bias_file(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error) && !error) return std::nullopt;
  auto table = TomlTable::load(path);
  if (!table) return tl::unexpected(table.error());
  const auto imu = table->text("imu");
  const auto saved_at = table->whole_number("saved_at_unix_s");
  const auto bias = read_axes(*table, "bias_rad_s");
  const auto sigma = read_axes(*table, "sigma_rad_s");
  if (table->error()) return tl::unexpected(*table->error());
  if (!imu || !saved_at || !bias || !sigma) {
    return bad_input(path.string() +
                     ": imu, saved_at_unix_s, bias_rad_s and sigma_rad_s are not all there");
  }
  KnownBias known{*imu, WallTime(std::chrono::seconds(*saved_at)), {*bias, *sigma}};
  if (!is_possible(known.time) || !is_possible(known.bias)) {
    return bad_input(path.string() + ": no gyroscope has such a bias or sigma, or at such a time");
  }
  return known;
}

Result<void> write_bias_file(const std::filesystem::path& path, const KnownBias& known) {
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  return replace_file(
      path, fmt::format("# The bias of a gyroscope when gimbald last ran, and its standard "
                        "deviation, for a start that knows it.\n"
                        "imu = \"{}\"\nsaved_at_unix_s = {}\nbias_rad_s = {}\nsigma_rad_s = {}\n",
                        known.imu, known.time.time_since_epoch().count(),
                        text_of(known.bias.bias_rad_s), text_of(known.bias.sigma_rad_s)));
}

}  // namespace gimbal
