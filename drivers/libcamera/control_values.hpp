#pragma once

#include <libcamera/libcamera.h>

#include <map>
#include <string>
#include <vector>

#include "pipeline/sample/result.hpp"

namespace gimbal {

/// A control's value of its type; several numbers make an array. Fails where they do not fit the
/// control's type or range.
[[nodiscard]] Result<libcamera::ControlValue> control_value(const libcamera::ControlId& id,
                                                            const libcamera::ControlInfo& info,
                                                            const std::vector<double>& numbers);

/// All of them, by name. An unknown name fails with the names that there are.
[[nodiscard]] Result<libcamera::ControlList> control_list(
    const libcamera::ControlInfoMap& known,
    const std::map<std::string, std::vector<double>>& values);

}  // namespace gimbal
