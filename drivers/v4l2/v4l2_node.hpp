#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/device_report.hpp"
#include "drivers/v4l2/picture_format.hpp"
#include "drivers/v4l2/sensor_timing.hpp"
#include "drivers/v4l2/v4l2_device.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// An open node that delivers pictures.
struct V4l2Node {
  std::string path;
  std::unique_ptr<V4l2Device> device;
  NodeIdentity identity;
};

/// `wanted`: a path, a camera's name or bus, or empty for the first that this driver can read.
[[nodiscard]] Result<V4l2Node> find_node(const V4l2System& system, const std::string& wanted);

/// As the camera is set now: by the node's own controls, else by those of its sensor.
[[nodiscard]] std::optional<SensorTiming> timing_of(const V4l2System& system, V4l2Node& node);

[[nodiscard]] std::vector<DeviceReport> report_nodes(const V4l2System& system);

}  // namespace gimbal
