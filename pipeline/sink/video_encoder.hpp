#pragma once

#include <string>
#include <vector>

#include "pipeline/sink/frame_sink.hpp"

namespace gimbal {

/// H.264 has even sizes only: without the last column or row of an odd one.
[[nodiscard]] SinkFormat with_even_size(SinkFormat format);

/// A way to H.264, as pipeline text from raw pictures of even size to what .mp4 and .mkv take.
struct VideoEncoder {
  const char* element;
  std::string text;
};

/// All that are known, the best first. None makes B-frames, so that pictures are stored in the
/// order of their times.
[[nodiscard]] std::vector<VideoEncoder> video_encoders(const SinkFormat& format);

/// The best that is installed; bad_input, with a package, if there is none.
[[nodiscard]] Result<VideoEncoder> choose_video_encoder(const SinkFormat& format);

/// The best that is installed for a stream that is seen at once: a constant rate of bits, nothing
/// held back, and a picture that stands alone every second, for those who come later.
[[nodiscard]] Result<VideoEncoder> choose_stream_encoder(const SinkFormat& format,
                                                         int bitrate_kbps);

/// The best that is installed for a recording that is made beside other work: little effort, good
/// quality, every frame written at once, and a picture that stands alone every second.
[[nodiscard]] Result<VideoEncoder> choose_recording_encoder(const SinkFormat& format);

}  // namespace gimbal
