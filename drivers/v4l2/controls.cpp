#include "drivers/v4l2/controls.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <system_error>

namespace gimbal {
namespace {

/// Against drivers whose lists have no end.
constexpr int kMostListed = 1024;

bool holds_a_number(std::uint32_t type) {
  switch (type) {
    case V4L2_CTRL_TYPE_INTEGER:
    case V4L2_CTRL_TYPE_BOOLEAN:
    case V4L2_CTRL_TYPE_MENU:
    case V4L2_CTRL_TYPE_INTEGER_MENU:
    case V4L2_CTRL_TYPE_BITMASK:
    case V4L2_CTRL_TYPE_BUTTON:
    case V4L2_CTRL_TYPE_INTEGER64:
      return true;
    default:
      return false;
  }
}

bool is_menu(const ControlInfo& control) {
  return control.type == V4L2_CTRL_TYPE_MENU || control.type == V4L2_CTRL_TYPE_INTEGER_MENU;
}

ControlInfo info_of(const v4l2_query_ext_ctrl& listed) {
  return {listed.id,      control_name(listed.name),
          listed.type,    listed.flags,
          listed.minimum, listed.maximum,
          listed.step};
}

std::string name_of(const v4l2_querymenu& entry) {
  std::array<char, sizeof entry.name> letters{};
  std::memcpy(letters.data(), &entry.name, letters.size());  // the struct is packed
  return {letters.begin(), std::ranges::find(letters, '\0')};
}

/// "0 (auto), 1 (manual)", as numbers and as the driver calls them.
std::string entries_of(V4l2Device& device, const ControlInfo& control) {
  std::vector<std::string> entries;
  for (std::int64_t index = control.minimum; index <= control.maximum; ++index) {
    v4l2_querymenu entry{};
    entry.id = control.id;
    entry.index = static_cast<std::uint32_t>(index);
    if (device.request(VIDIOC_QUERYMENU, &entry) != 0) continue;
    if (control.type == V4L2_CTRL_TYPE_INTEGER_MENU) {
      entries.push_back(fmt::format("{} ({})", index, std::int64_t{entry.value}));
    } else {
      entries.push_back(fmt::format("{} ({})", index, name_of(entry)));
    }
  }
  return fmt::format("{}", fmt::join(entries, ", "));
}

bool has_entry(V4l2Device& device, const ControlInfo& control, std::int64_t index) {
  v4l2_querymenu entry{};
  entry.id = control.id;
  entry.index = static_cast<std::uint32_t>(index);
  return device.request(VIDIOC_QUERYMENU, &entry) == 0;
}

Result<void> check_value(V4l2Device& device, const ControlInfo& control, std::int64_t value) {
  if ((control.flags & V4L2_CTRL_FLAG_READ_ONLY) != 0) {
    return bad_input(fmt::format("control {} can only be read", control.name));
  }
  if (control.type == V4L2_CTRL_TYPE_BUTTON) return {};
  const bool is_bitmask = control.type == V4L2_CTRL_TYPE_BITMASK;
  const bool fits = is_bitmask ? (value & ~control.maximum) == 0
                               : value >= control.minimum && value <= control.maximum;
  if (is_menu(control) && (!fits || !has_entry(device, control, value))) {
    return bad_input(fmt::format("control {} has no entry {}; it has {}", control.name, value,
                                 entries_of(device, control)));
  }
  if (!fits) {
    return bad_input(fmt::format("control {} is {}, and has to be from {} to {}", control.name,
                                 value, control.minimum, control.maximum));
  }
  return {};
}

Result<void> set_control(V4l2Device& device, const ControlInfo& control, std::int64_t value) {
  if (auto checked = check_value(device, control, value); !checked) return checked;
  v4l2_ext_control set{};
  set.id = control.id;
  if (control.type == V4L2_CTRL_TYPE_INTEGER64) {
    set.value64 = value;
  } else {
    set.value = static_cast<std::int32_t>(value);
  }
  v4l2_ext_controls all{};
  all.which = V4L2_CTRL_WHICH_CUR_VAL;
  all.count = 1;
  all.controls = &set;
  const int error = device.request(VIDIOC_S_EXT_CTRLS, &all);
  if (error != 0) {
    const bool is_inactive = (control.flags & V4L2_CTRL_FLAG_INACTIVE) != 0;
    return failed(
        fmt::format("control {} cannot be set to {}: {}{}", control.name, value,
                    std::generic_category().message(error),
                    is_inactive ? "; another control, such as an automatic, has it" : ""));
  }
  return {};
}

const ControlInfo* find_control(const std::vector<ControlInfo>& controls, const std::string& name) {
  const auto found =
      std::ranges::find_if(controls, [&](const ControlInfo& c) { return c.name == name; });
  return found == controls.end() ? nullptr : &*found;
}

tl::unexpected<Error> unknown(const std::string& name, const std::vector<ControlInfo>& controls) {
  std::vector<std::string> names;
  names.reserve(controls.size());
  for (const ControlInfo& control : controls) names.push_back(control.name);
  return bad_input(fmt::format("has no control {}; it has {}", name,
                               names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

}  // namespace

std::string control_name(std::string_view name) {
  std::string spelt;
  bool is_between = false;
  for (const char letter : name) {
    const auto byte = static_cast<unsigned char>(letter);
    if (std::isalnum(byte) == 0) {
      is_between = !spelt.empty();
      continue;
    }
    if (is_between) spelt += '_';
    is_between = false;
    spelt += static_cast<char>(std::tolower(byte));
  }
  return spelt;
}

std::vector<ControlInfo> list_controls(V4l2Device& device) {
  std::vector<ControlInfo> controls;
  v4l2_query_ext_ctrl listed{};
  for (int i = 0; i < kMostListed; ++i) {
    listed.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    if (device.request(VIDIOC_QUERY_EXT_CTRL, &listed) != 0) break;
    const bool is_usable =
        holds_a_number(listed.type) && (listed.flags & V4L2_CTRL_FLAG_DISABLED) == 0;
    if (is_usable) controls.push_back(info_of(listed));
  }
  return controls;
}

std::optional<std::int64_t> get_control(V4l2Device& device, std::uint32_t id) {
  v4l2_query_ext_ctrl described{};
  described.id = id;
  if (device.request(VIDIOC_QUERY_EXT_CTRL, &described) != 0) return std::nullopt;
  v4l2_ext_control value{};
  value.id = id;
  v4l2_ext_controls all{};
  all.which = V4L2_CTRL_WHICH_CUR_VAL;
  all.count = 1;
  all.controls = &value;
  if (device.request(VIDIOC_G_EXT_CTRLS, &all) != 0) return std::nullopt;
  return described.type == V4L2_CTRL_TYPE_INTEGER64 ? value.value64 : value.value;
}

Result<void> set_controls(V4l2Device& device, const std::map<std::string, std::int64_t>& values) {
  if (values.empty()) return {};
  const std::vector<ControlInfo> before = list_controls(device);
  std::vector<std::string> later;
  for (const auto& [name, value] : values) {
    const ControlInfo* control = find_control(before, name);
    if (control == nullptr) return unknown(name, before);
    if ((control->flags & V4L2_CTRL_FLAG_INACTIVE) != 0) {
      later.push_back(name);
    } else if (auto set = set_control(device, *control, value); !set) {
      return set;
    }
  }
  if (later.empty()) return {};
  const std::vector<ControlInfo> after = list_controls(device);
  for (const std::string& name : later) {
    const ControlInfo* control = find_control(after, name);
    if (control == nullptr) return unknown(name, after);
    if (auto set = set_control(device, *control, values.at(name)); !set) return set;
  }
  return {};
}

std::optional<SensorDuration> fixed_exposure(V4l2Device& device) {
  const auto automatic = get_control(device, V4L2_CID_EXPOSURE_AUTO);
  const bool is_fixed = !automatic || *automatic == V4L2_EXPOSURE_MANUAL ||
                        *automatic == V4L2_EXPOSURE_SHUTTER_PRIORITY;
  const auto units = is_fixed ? get_control(device, V4L2_CID_EXPOSURE_ABSOLUTE) : std::nullopt;
  if (!units || *units <= 0) return std::nullopt;
  return *units * std::chrono::microseconds(100);
}

}  // namespace gimbal
