#include "drivers/iio/device_setup.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <string>

#include "drivers/iio/sampling_frequency.hpp"

namespace gimbal {
namespace {

constexpr const char* kClockAttribute = "current_timestamp_clock";
constexpr const char* kRateAttribute = "sampling_frequency";

std::optional<double> number_in(const std::optional<std::string>& text) {
  if (!text) return std::nullopt;
  char* end = nullptr;
  const double number = std::strtod(text->c_str(), &end);
  return end != text->c_str() ? std::optional(number) : std::nullopt;
}

std::string read_clock(const iio_device& device) {
  std::array<char, 64> text{};
  const auto length = iio_device_attr_read(&device, kClockAttribute, text.data(), text.size());
  return length > 0 ? text.data() : "";
}

long write_rate(const iio_channel& axis, double rate_hz) {
  const std::string text = fmt::format("{:.6f}", rate_hz);
  if (iio_channel_find_attr(&axis, kRateAttribute) != nullptr) {
    return iio_channel_attr_write(&axis, kRateAttribute, text.c_str());
  }
  return iio_device_attr_write(iio_channel_get_device(&axis), kRateAttribute, text.c_str());
}

/// Of `mount_matrix` shared by type, by direction, or by the whole device.
std::optional<std::string> read_mount_matrix(const iio_channel& axis) {
  for (const char* name : {"mount_matrix", "in_mount_matrix"}) {
    if (auto text = read_attribute(axis, name)) return text;
  }
  return std::nullopt;
}

}  // namespace

Result<void> set_monotonic_clock(const iio_device& device) {
  if (iio_device_find_attr(&device, kClockAttribute) == nullptr) return {};  // it has no choice
  if (read_clock(device) == "monotonic") return {};
  auto written = iio_device_attr_write(&device, kClockAttribute, "monotonic");
  if (written == -EBUSY) {
    [[maybe_unused]] const auto off = iio_device_buffer_attr_write(&device, "enable", "0");
    written = iio_device_attr_write(&device, kClockAttribute, "monotonic");
  }
  if (read_clock(device) == "monotonic") return {};
  const std::string why = written < 0 ? iio_error_text(written) : "it keeps " + read_clock(device);
  return failed(
      fmt::format("{}: cannot set its stamps' clock to monotonic: {}", title_of(device), why));
}

Result<std::optional<double>> set_rate(const iio_device& device, IioTriad triad, double wish_hz) {
  const iio_channel& axis = *find_axis(device, triad, 0);
  const auto before = number_in(read_attribute(axis, kRateAttribute));
  if (!before) return std::optional<double>();
  const auto available = read_attribute(axis, "sampling_frequency_available");
  const double rate_hz = nearest_frequency(available.value_or(""), wish_hz).value_or(wish_hz);
  const auto written = write_rate(axis, rate_hz);
  const auto after = number_in(read_attribute(axis, kRateAttribute));
  if (written >= 0 || after.value_or(0) >= 0.99 * wish_hz) return after;
  return failed(fmt::format("{}: cannot change its rate from {:g} to {:g} Hz: {}", title_of(device),
                            *before, rate_hz, iio_error_text(written)));
}

Result<AxesScaling> read_scaling(const iio_device& device, IioTriad triad) {
  AxesScaling scaling;
  for (int axis = 0; axis < 3; ++axis) {
    const iio_channel& channel = *find_axis(device, triad, axis);
    const auto scale = number_in(read_attribute(channel, "scale"));
    if (!scale || *scale == 0) {
      return failed(
          fmt::format("{}: {} has no scale", title_of(device), iio_channel_get_id(&channel)));
    }
    scaling.scale[axis] = *scale;
    scaling.offset[axis] = number_in(read_attribute(channel, "offset")).value_or(0);
  }
  if (const auto text = read_mount_matrix(*find_axis(device, triad, 0))) {
    const auto matrix = parse_mount_matrix(*text);
    if (!matrix) {
      return bad_input(fmt::format("{}: {}", title_of(device), matrix.error().message));
    }
    scaling.R_board_chip = *matrix;
  }
  return scaling;
}

}  // namespace gimbal
