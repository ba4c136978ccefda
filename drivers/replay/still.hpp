#pragma once

#include <filesystem>
#include <optional>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Writes one picture as .jpg or .png, by the path's extension: a session's thumbnail, say. With a
/// width it is scaled to that, keeping its proportions. Colours are converted from the frame's own
/// matrix and range.
[[nodiscard]] Result<void> write_still(const VideoFrame& frame, const std::filesystem::path& path,
                                       std::optional<int> width = std::nullopt);

}  // namespace gimbal
