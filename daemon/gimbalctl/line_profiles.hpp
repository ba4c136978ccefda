#pragma once

#include "pipeline/calibration/flashing_light.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// How bright each row is, or each column for sensors that read columns, in the order of readout.
[[nodiscard]] LineProfile line_profile(const VideoFrame& frame, ReadoutDirection direction);

}  // namespace gimbal
