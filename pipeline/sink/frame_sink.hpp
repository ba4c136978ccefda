#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Where pictures go.
class FrameSink {
 public:
  FrameSink() = default;
  FrameSink(const FrameSink&) = delete;
  FrameSink& operator=(const FrameSink&) = delete;
  virtual ~FrameSink() = default;

  /// Waits while the consumer is behind. A frame's presentation time is its stamp less the first
  /// frame's. Stamps must rise.
  [[nodiscard]] virtual Result<void> write(const VideoFrame& frame) = 0;

  /// Ends the stream properly and waits until everything is written. Without it a file is left
  /// unfinished.
  [[nodiscard]] virtual Result<void> finish() = 0;

  /// Of all pictures together, from one place in memory to another on their way out, changes of
  /// their format included. Nothing: not counted.
  [[nodiscard]] virtual std::optional<std::int64_t> bytes_copied() const { return std::nullopt; }

  /// What is written otherwise than asked, such as audio left out, a line each; complete after
  /// `finish`.
  [[nodiscard]] virtual std::vector<std::string> warnings() const = 0;
};

/// How pictures that are seen as they are taken lie in time.
struct LiveTiming {
  SensorTime first;        ///< the first picture's stamp, CLOCK_MONOTONIC
  SensorDuration delay{};  ///< the longest that a picture is behind its stamp when it is written
};

/// The pictures that a sink will get.
struct SinkFormat {
  ImageSize size;
  double fps = 0;  ///< nominal; capture times set the pace
  ColorInfo color;
  /// A pipeline's clock is then CLOCK_MONOTONIC, and base time and presentation time together are
  /// the capture time. None: a recording, written as fast as it comes.
  std::optional<LiveTiming> live = std::nullopt;
};

/// Audio to be carried over from a recording, unchanged.
struct AudioTrack {
  std::filesystem::path file;
  SensorDuration
      offset{};  ///< added to the file's stamps: what is at 0 in the output is at -offset
};

/// `out`: a path ending in .mp4, .mkv or .y4m; "-" for y4m on standard output; or, with " ! " in
/// it, a GStreamer pipeline that the pictures are fed into. Audio goes into .mp4 and .mkv only.
[[nodiscard]] Result<std::unique_ptr<FrameSink>> open_sink(const std::string& out,
                                                           const SinkFormat& format,
                                                           const std::optional<AudioTrack>& audio);

/// Fails where `out` is none of these, as opening it would at any time.
[[nodiscard]] Result<void> check_sink_text(const std::string& out);

}  // namespace gimbal
