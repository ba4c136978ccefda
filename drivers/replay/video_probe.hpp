#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/sensor_time.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// What a video file says of its first video stream.
struct VideoInfo {
  ImageSize size;
  double fps = 0;                ///< nominal, or else the mean; 0 if neither is known
  std::int64_t frame_count = 0;  ///< coded pictures, as far as the file can be read
  bool has_audio = false;
  /// The container's presentation times, rising, by the clock that its audio uses too; one a
  /// picture, or none if the container lacks some. For recordings without a frame list of their own
  /// only.
  std::vector<SensorDuration> frame_times;
  std::string damage;  ///< why reading stopped early; empty if it did not
};

/// Reads the whole file once, without decoding it: no decoder need be installed. bad_input if it
/// holds no video; ends, one way or the other, within seconds after the file yields nothing more.
[[nodiscard]] Result<VideoInfo> probe_video(const std::filesystem::path& path);

}  // namespace gimbal
