#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/sink/frame_sink.hpp"

namespace gimbal {

/// ".mp4" for "Holiday.MP4".
[[nodiscard]] std::string lower_case_extension(const std::filesystem::path& path);

/// H.264 in an .mp4 or .mkv, by the best encoder that is installed. Without B-frames, so that
/// pictures are stored in the order of their times. Presentation times are rounded to 1/90000 s in
/// .mp4 and to 0.1 ms in .mkv. 4:2:0 has no odd sizes: the last column or row is left out then.
[[nodiscard]] Result<std::unique_ptr<FrameSink>> open_video_file(
    const std::filesystem::path& path, const SinkFormat& format,
    const std::optional<AudioTrack>& audio);

}  // namespace gimbal
