#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <variant>

#include "pipeline/sample/result.hpp"
#include "pipeline/sink/frame_sink.hpp"
#include "pipeline/sink/rtsp_sink.hpp"

namespace gimbal {

/// What `gimbalctl stabilize -o` takes as well: "-", a file, or a pipeline text.
struct TextOutput {
  std::string text;

  bool operator==(const TextOutput&) const = default;
};

/// I420 pictures on standard output, one after the other, with nothing between them.
struct RawStdoutOutput {
  bool operator==(const RawStdoutOutput&) const = default;
};

/// Files of equal length, one after the other, named after the time when the first was begun.
struct SegmentOutput {
  std::filesystem::path folder;
  SensorDuration length = std::chrono::minutes(10);
  int kept = 0;       ///< the oldest of this run go when there are more; 0: all stay
  std::string audio;  ///< pipeline text of a live source; empty for none

  bool operator==(const SegmentOutput&) const = default;
};

/// To clients that ask for it.
using RtspOutput = RtspSettings;

/// H.264 in RTP (RFC 6184), payload type 96, sent whether somebody listens or not.
struct UdpOutput {
  std::string host = "127.0.0.1";
  int port = 5000;
  int bitrate_kbps = 4000;

  bool operator==(const UdpOutput&) const = default;
};

/// A camera for other programs, through the kernel's v4l2loopback.
struct LoopbackOutput {
  std::filesystem::path device;

  bool operator==(const LoopbackOutput&) const = default;
};

/// I420 pictures in memory that GStreamer's shmsrc reads.
struct ShmOutput {
  std::filesystem::path socket;

  bool operator==(const ShmOutput&) const = default;
};

/// On this machine's screen.
struct DisplayOutput {
  bool operator==(const DisplayOutput&) const = default;
};

using OutputSettings = std::variant<TextOutput, RawStdoutOutput, SegmentOutput, RtspOutput,
                                    UdpOutput, LoopbackOutput, ShmOutput, DisplayOutput>;

/// Whether an output that has failed may be opened again: a file would lose what it holds, but not
/// before it was open, and standard output is not there any more.
enum class Reopening : std::uint8_t { possible, until_open, impossible };

/// Somewhere that pictures can be sent to.
struct OutputTarget {
  std::string name;  ///< for people
  Reopening reopening = Reopening::possible;
  std::function<Result<std::unique_ptr<FrameSink>>(const SinkFormat&)> open;
};

[[nodiscard]] OutputTarget target_of(const OutputSettings& settings);

}  // namespace gimbal
