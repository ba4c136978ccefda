#pragma once

#include <string>

namespace gimbal {

/// Why open(2) of a device node failed with `error`, and what to do about it; a missing permission
/// names the group that the node belongs to.
[[nodiscard]] std::string why_not_open(const std::string& path, int error);

}  // namespace gimbal
