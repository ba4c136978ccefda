#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/v4l2/v4l2_device.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// A name as `v4l2-ctl` spells it: lower case, with one underscore for all that lies between
/// letters and digits.
[[nodiscard]] std::string control_name(std::string_view name);

struct ControlInfo {
  std::uint32_t id = 0;
  std::string name;
  std::uint32_t type = 0;   ///< V4L2_CTRL_TYPE_*
  std::uint32_t flags = 0;  ///< V4L2_CTRL_FLAG_*
  std::int64_t minimum = 0;
  std::int64_t maximum = 0;
  std::uint64_t step = 1;
};

/// Those that hold one number.
[[nodiscard]] std::vector<ControlInfo> list_controls(V4l2Device& device);

[[nodiscard]] std::optional<std::int64_t> get_control(V4l2Device& device, std::uint32_t id);

/// Sets controls by name. Those that another control makes inactive ("auto") come last. Fails for
/// an unknown name with the names that there are, for a value outside its range with the range.
[[nodiscard]] Result<void> set_controls(V4l2Device& device,
                                        const std::map<std::string, std::int64_t>& values);

/// How long exposure lasts, where it is fixed and the device tells (V4L2_CID_EXPOSURE_ABSOLUTE).
[[nodiscard]] std::optional<SensorDuration> fixed_exposure(V4l2Device& device);

}  // namespace gimbal
