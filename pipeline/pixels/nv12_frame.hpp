#pragma once

#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// The frame itself where it is NV12; a copy that is converted, and holds nothing of the frame's
/// memory, where it is native.
[[nodiscard]] VideoFrame as_nv12(const VideoFrame& frame);

}  // namespace gimbal
