#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "drivers/replay/import/byte_view.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/sensor_time.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// One picture, or one payload of a metadata track.
struct Mp4Sample {
  std::uint64_t offset = 0;  ///< in the file
  std::uint32_t size = 0;
  SensorDuration time{};  ///< since the track's start, in order of decoding
  SensorDuration duration{};
};

struct Mp4Track {
  FourCc handler = 0;  ///< "vide", "soun", "meta"
  FourCc format = 0;   ///< of the first sample description: "avc1", "gpmd"
  ImageSize size;      ///< of a video track
  std::vector<Mp4Sample> samples;
};

/// The tracks of an MP4 or QuickTime file (ISO/IEC 14496-12), from its moov box. Edit lists and
/// composition offsets are passed over. The file is not trusted: a track whose tables do not fit
/// together or reach beyond the file's end is left out.
[[nodiscard]] Result<std::vector<Mp4Track>> read_mp4_tracks(const std::filesystem::path& path);

/// True if the file begins like an MP4 or QuickTime file.
[[nodiscard]] bool looks_like_mp4(const std::filesystem::path& path);

/// A sample's bytes.
[[nodiscard]] Result<std::vector<std::uint8_t>> read_mp4_sample(const std::filesystem::path& path,
                                                                const Mp4Sample& sample);

}  // namespace gimbal
