#pragma once

#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// What is shown while no camera delivers: the words NO SIGNAL on grey.
[[nodiscard]] VideoFrame no_signal_picture(ImageSize size, const ColorInfo& color);

}  // namespace gimbal
