#include "drivers/v4l2/v4l2_node.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cerrno>
#include <optional>
#include <utility>

#include "drivers/v4l2/controls.hpp"
#include "drivers/v4l2/sensor_timing.hpp"
#include "drivers/v4l2/stamp_clock.hpp"

namespace gimbal {
namespace {

Result<V4l2Node> open_node(const V4l2System& system, const std::string& path) {
  auto device = system.open(path);
  if (!device) return tl::unexpected(device.error());
  auto identity = identify(**device);
  if (!identity) return bad_input(path + ": " + identity.error().message);
  if (!identity->obstacle.empty()) return bad_input(path + ": " + identity->obstacle);
  return V4l2Node{path, std::move(*device), std::move(*identity)};
}

Result<V4l2Node> first_readable(const V4l2System& system) {
  std::vector<std::string> obstacles;
  for (const std::string& path : system.nodes()) {
    auto node = open_node(system, path);
    if (!node) {
      obstacles.push_back(node.error().message);
      continue;
    }
    const auto formats = offered_formats(*node->device, node->identity.type, {});
    const auto choice = choose_format(formats, {});
    if (choice) return node;
    obstacles.push_back(path + ": " + choice.error().message);
  }
  if (obstacles.empty()) {
    return bad_input("there is no camera: no /dev/video*; is it plugged in, its driver loaded?");
  }
  return bad_input(fmt::format("no camera can be used: {}", fmt::join(obstacles, "; ")));
}

/// A camera has several nodes of one name, of which the others deliver no pictures.
Result<V4l2Node> called(const V4l2System& system, const std::string& name) {
  std::vector<std::string> others;
  for (const std::string& path : system.nodes()) {
    auto node = open_node(system, path);
    if (!node) continue;
    if (node->identity.name == name || node->identity.bus == name) return node;
    others.push_back(fmt::format("{} ({})", node->identity.name, path));
  }
  return bad_input(fmt::format(
      "no camera is called '{}'; there is {}", name,
      others.empty() ? "none that can be used" : fmt::format("{}", fmt::join(others, ", "))));
}

/// What a single buffer tells; it is handed back at once.
struct BufferProbe {
  int error = 0;
  std::uint32_t flags = 0;
};

BufferProbe probe_buffer(V4l2Device& device, std::uint32_t type) {
  v4l2_requestbuffers buffers{};
  buffers.count = 1;
  buffers.type = type;
  buffers.memory = V4L2_MEMORY_MMAP;
  BufferProbe probe;
  probe.error = device.request(VIDIOC_REQBUFS, &buffers);
  if (probe.error != 0) return probe;
  v4l2_plane planes[VIDEO_MAX_PLANES] = {};
  v4l2_buffer buffer{};
  buffer.type = type;
  buffer.memory = V4L2_MEMORY_MMAP;
  if (V4L2_TYPE_IS_MULTIPLANAR(type)) {
    buffer.m.planes = planes;
    buffer.length = VIDEO_MAX_PLANES;
  }
  if (device.request(VIDIOC_QUERYBUF, &buffer) == 0) probe.flags = buffer.flags;
  buffers.count = 0;
  static_cast<void>(device.request(VIDIOC_REQBUFS, &buffers));
  return probe;
}

void describe_node(const V4l2System& system, V4l2Node& node, DeviceReport& report) {
  const std::uint32_t type = node.identity.type;
  const auto formats = offered_formats(*node.device, type, current_size(*node.device, type));
  for (const OfferedFormat& format : formats) report.details.push_back(describe(format));
  const auto choice = choose_format(formats, {});
  if (!choice) report.obstacle = choice.error().message;

  const BufferProbe probe = probe_buffer(*node.device, type);
  if (probe.error == EBUSY) {
    const std::string users = system.users_of(node.path);
    report.obstacle = "busy: in use by " + (users.empty() ? "another program" : users);
  } else if (probe.error == 0) {
    report.details.push_back(describe_stamps(probe.flags));
  }
  if (const auto timing = timing_of(system, node)) {
    report.details.push_back(
        fmt::format("readout: {:.2f} ms as it is set now", to_seconds(timing->readout) * 1e3));
  }
  const auto controls = list_controls(*node.device);
  std::vector<std::string> names;
  names.reserve(controls.size());
  for (const ControlInfo& control : controls) names.push_back(control.name);
  if (!names.empty()) {
    report.details.push_back(fmt::format("controls: {}", fmt::join(names, ", ")));
  }
}

/// Without the path in front, which the report shows anyway.
std::string without(const std::string& path, const std::string& message) {
  const std::string prefix = path + ": ";
  return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
}

DeviceReport report_node(const V4l2System& system, const std::string& path) {
  DeviceReport report{"v4l2", path, {}, {}, {}};
  auto device = system.open(path);
  if (!device) {
    report.obstacle = without(path, device.error().message);
    return report;
  }
  auto identity = identify(**device);
  if (!identity) {
    report.obstacle = identity.error().message;
    return report;
  }
  report.name = identity->name;
  report.obstacle = identity->obstacle;
  report.details.push_back("bus: " + identity->bus);
  if (!report.obstacle.empty()) return report;
  V4l2Node node{path, std::move(*device), std::move(*identity)};
  describe_node(system, node, report);
  return report;
}

}  // namespace

Result<V4l2Node> find_node(const V4l2System& system, const std::string& wanted) {
  if (wanted.empty()) return first_readable(system);
  if (wanted.starts_with('/')) return open_node(system, wanted);
  return called(system, wanted);
}

std::optional<SensorTiming> timing_of(const V4l2System& system, V4l2Node& node) {
  if (const auto size = current_size(*node.device, node.identity.type)) {
    if (auto timing = read_sensor_timing(*node.device, *size)) return timing;
  }
  const auto sensor = system.open_sensor(node.path);
  const auto size = sensor ? sensor_size(*sensor) : std::nullopt;
  return size ? read_sensor_timing(*sensor, *size) : std::nullopt;
}

std::vector<DeviceReport> report_nodes(const V4l2System& system) {
  const auto paths = system.nodes();
  std::vector<DeviceReport> reports;
  reports.reserve(paths.size());
  for (const std::string& path : paths) reports.push_back(report_node(system, path));
  return reports;
}

}  // namespace gimbal
