#pragma once

#include <span>

#include "pipeline/path/camera_path.hpp"

namespace gimbal {

/// Root mean square of the camera's angular rate above `cutoff_hz`, rad/s, all three axes together:
/// the rate between neighbouring frames less its low-passed self (a Hann window of two of the
/// cut-off's periods). 0 for fewer than two poses.
[[nodiscard]] double rms_rate_above_rad_s(std::span<const FramePose> poses, double cutoff_hz);

}  // namespace gimbal
