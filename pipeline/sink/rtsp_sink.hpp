#pragma once

#include <memory>
#include <string>

#include "pipeline/sample/result.hpp"
#include "pipeline/sink/frame_sink.hpp"

namespace gimbal {

/// Where and how clients get the pictures by RTSP (RFC 2326), as H.264.
struct RtspSettings {
  std::string address = "127.0.0.1";  ///< of the interface that is listened on
  int port = 8554;                    ///< 0: any that is free
  std::string path = "/gimbald";
  int bitrate_kbps = 4000;
  std::string audio;  ///< pipeline text of a live source; empty for none

  bool operator==(const RtspSettings&) const = default;
};

/// Serves any number of clients from one encoder, which runs only while there are some. Writing
/// never waits for them. Stamps are the capture's; see LiveTiming, which must be given.
class RtspSink : public FrameSink {
 public:
  [[nodiscard]] static Result<std::unique_ptr<RtspSink>> start(const RtspSettings& settings,
                                                               const SinkFormat& format);

  /// What a client opens.
  [[nodiscard]] virtual std::string url() const = 0;
};

}  // namespace gimbal
