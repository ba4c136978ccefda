#pragma once

#include "pipeline/sample/result.hpp"
#include "pipeline/sync/corner_follower.hpp"

namespace gimbal {

/// Loads gimbald-corners.so, which lies beside the program where both were built, and in libexec
/// where they are installed. bad_input if it is not there. It stays until the program ends.
[[nodiscard]] Result<const CornerFollower*> load_corner_follower();

}  // namespace gimbal
