#pragma once

#include <string>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Reads the value of an option --size, such as "1280x720".
[[nodiscard]] Result<ImageSize> parse_picture_size(const std::string& text);

}  // namespace gimbal
