#include "drivers/iio/libiio.hpp"

#include <fmt/format.h>
#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "drivers/iio/trigger.hpp"

namespace gimbal {
namespace {

constexpr std::size_t kAttributeLength = 4096;  // a sysfs file is at most a page

bool has_triad(const iio_device& device, IioTriad triad) {
  for (int axis = 0; axis < 3; ++axis) {
    if (find_axis(device, triad, axis) == nullptr) return false;
  }
  return true;
}

std::string text_or_empty(const char* text) {
  return text != nullptr ? text : "";
}

std::string group_of(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return "?";
  const group* entry = getgrgid(status.st_gid);
  return entry != nullptr ? entry->gr_name : std::to_string(status.st_gid);
}

std::string permission_obstacle(const std::string& path) {
  if (access(path.c_str(), R_OK | W_OK) == 0) return {};
  if (errno != EACCES) return fmt::format("{}: {}", path, std::strerror(errno));
  return fmt::format("no permission on {}; join the group {} or run as root", path, group_of(path));
}

/// Why samples cannot be had; empty if nothing is in the way. Whether a trigger is in the way shows
/// only when no name is given for one.
std::string obstacle_of(const iio_device& device) {
  const auto* any = find_axis(device, IioTriad::gyro, 0);
  if (any == nullptr) any = find_axis(device, IioTriad::accel, 0);
  if (any == nullptr || !iio_channel_is_scan_element(any)) {
    return "has no buffer; its driver wants an interrupt line in the device tree";
  }
  const auto* timestamp = find_timestamp(device);
  if (timestamp == nullptr || !iio_channel_is_scan_element(timestamp)) {
    return "has no timestamp channel";
  }
  const std::string id = iio_device_get_id(&device);
  for (const std::string& path : {"/dev/" + id, "/sys/bus/iio/devices/" + id + "/buffer/enable"}) {
    if (auto obstacle = permission_obstacle(path); !obstacle.empty()) return obstacle;
  }
  return {};
}

}  // namespace

Result<IioContext> scan_iio_devices() {
  IioContext context(iio_create_local_context());
  if (!context) {
    // Without any device there is no context.
    if (errno == ENOENT || errno == ENODEV) {
      return bad_input("iio: the kernel shows no IIO device in /sys/bus/iio/devices");
    }
    return failed(fmt::format("iio: cannot look for devices: {}", std::strerror(errno)));
  }
  return context;
}

iio_channel* find_axis(const iio_device& device, IioTriad triad, int axis) {
  static constexpr std::array<std::array<const char*, 3>, 2> kNames{
      {{"anglvel_x", "anglvel_y", "anglvel_z"}, {"accel_x", "accel_y", "accel_z"}}};
  const auto& names = kNames.at(static_cast<std::size_t>(triad));
  return iio_device_find_channel(&device, names.at(static_cast<std::size_t>(axis)), false);
}

iio_channel* find_timestamp(const iio_device& device) {
  return iio_device_find_channel(&device, "timestamp", false);
}

std::string title_of(const iio_device& device) {
  return IioCandidate{.id = iio_device_get_id(&device),
                      .name = text_or_empty(iio_device_get_name(&device)),
                      .label = {}}
      .title();
}

std::vector<IioCandidate> find_candidates(const iio_context& context) {
  std::vector<IioCandidate> candidates;
  for (unsigned i = 0; i < iio_context_get_devices_count(&context); ++i) {
    const iio_device& device = *iio_context_get_device(&context, i);
    const bool has_gyro = has_triad(device, IioTriad::gyro);
    const bool has_accel = has_triad(device, IioTriad::accel);
    if (!has_gyro && !has_accel) continue;
    candidates.push_back({.id = iio_device_get_id(&device),
                          .name = text_or_empty(iio_device_get_name(&device)),
                          .label = text_or_empty(iio_device_get_label(&device)),
                          .has_gyro = has_gyro,
                          .has_accel = has_accel,
                          .obstacle = obstacle_of(device)});
  }
  return candidates;
}

std::optional<std::string> read_attribute(const iio_channel& channel, const std::string& name) {
  std::array<char, kAttributeLength> text{};
  if (iio_channel_attr_read(&channel, name.c_str(), text.data(), text.size()) > 0) {
    return text.data();
  }
  const iio_device* device = iio_channel_get_device(&channel);
  if (iio_device_attr_read(device, name.c_str(), text.data(), text.size()) > 0) return text.data();
  return std::nullopt;
}

std::string iio_error_text(long error) {
  return std::strerror(static_cast<int>(-error));
}

}  // namespace gimbal
