#include "daemon/output_target.hpp"

#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "daemon/name_now.hpp"
#include "pipeline/sink/pipeline_text.hpp"
#include "pipeline/sink/video_encoder.hpp"

namespace gimbal {
namespace {

using OpenedSink = Result<std::unique_ptr<FrameSink>>;

/// A pipeline that encodes first.
template <typename TextOf>
OpenedSink open_encoded(const SinkFormat& given, int bitrate_kbps, const TextOf& text_of) {
  const SinkFormat format = with_even_size(given);
  return choose_stream_encoder(format, bitrate_kbps).and_then([&](const VideoEncoder& encoder) {
    return open_sink(text_of(encoder), format, std::nullopt);
  });
}

Reopening reopening_of(const std::string& text) {
  if (text == "-") return Reopening::impossible;
  return text.find(" ! ") != std::string::npos ? Reopening::possible : Reopening::until_open;
}

OutputTarget target(const TextOutput& output) {
  return {output.text, reopening_of(output.text), [text = output.text](const SinkFormat& format) {
            return open_sink(text, format, std::nullopt);
          }};
}

OutputTarget target(const RawStdoutOutput&) {
  return {"standard output, raw", Reopening::impossible, [](const SinkFormat& format) {
            return open_sink("videoconvert ! video/x-raw,format=I420 ! fdsink fd=1 sync=false",
                             format, std::nullopt);
          }};
}

std::string audio_text(const std::string& source, const char* encoder, const char* to) {
  if (source.empty()) return "";
  // Sound is here at once, pictures after the lag: the muxer waits for both.
  return fmt::format(
      "  {} ! queue max-size-time=0 max-size-bytes=0 max-size-buffers=0 ! audioconvert ! "
      "audioresample ! {} ! {}",
      source, encoder, to);
}

OutputTarget target(const SegmentOutput& output) {
  return {output.folder.string(), Reopening::possible, [output](const SinkFormat& given) {
            std::error_code error;
            std::filesystem::create_directories(output.folder, error);
            if (error) {
              return OpenedSink(bad_input(fmt::format("{}: cannot make this folder: {}",
                                                      output.folder.string(), error.message())));
            }
            const std::filesystem::path files = output.folder / (name_now() + "_%05d.mkv");
            const SinkFormat format = with_even_size(given);
            return choose_video_encoder(format).and_then([&](const VideoEncoder& encoder) {
              const std::string text = fmt::format(
                  "{} ! h264parse ! splitmuxsink name=muxer location={} max-size-time={} "
                  "max-files={} send-keyframe-requests=true async-finalize=true "
                  "muxer-factory=matroskamux{}",
                  encoder.text, in_pipeline_quotes(files.string()), output.length.count(),
                  output.kept, audio_text(output.audio, "opusenc", "muxer.audio_0"));
              return open_sink(text, format, std::nullopt);
            });
          }};
}

OutputTarget target(const RtspOutput& output) {
  return {fmt::format("rtsp://{}:{}{}", output.address, output.port, output.path),
          Reopening::possible, [output](const SinkFormat& format) {
#ifdef GIMBALD_HAS_RTSP
            auto sink = RtspSink::start(output, format);
            return sink ? OpenedSink(std::move(*sink)) : OpenedSink(tl::unexpected(sink.error()));
#else
            (void)format;
            return OpenedSink(bad_input("this gimbald was built without RTSP"));
#endif
          }};
}

OutputTarget target(const UdpOutput& output) {
  return {fmt::format("udp://{}:{}", output.host, output.port), Reopening::possible,
          [output](const SinkFormat& format) {
            return open_encoded(format, output.bitrate_kbps, [&](const VideoEncoder& encoder) {
              return fmt::format(
                  "{} ! rtph264pay pt=96 config-interval=-1 ! udpsink host={} port={} sync=false",
                  encoder.text, in_pipeline_quotes(output.host), output.port);
            });
          }};
}

OutputTarget target(const LoopbackOutput& output) {
  return {
      output.device.string(), Reopening::possible, [output](const SinkFormat& format) {
        return open_sink(
            fmt::format("videoconvert ! video/x-raw,format=YUY2 ! v4l2sink device={} sync=false",
                        in_pipeline_quotes(output.device.string())),
            format, std::nullopt);
      }};
}

OutputTarget target(const ShmOutput& output) {
  return {output.socket.string(), Reopening::possible, [output](const SinkFormat& format) {
            std::error_code ignored;  // left by a process that was killed
            if (std::filesystem::is_socket(output.socket, ignored)) {
              std::filesystem::remove(output.socket, ignored);
            }
            return open_sink(
                fmt::format("videoconvert ! video/x-raw,format=I420 ! shmsink socket-path={} "
                            "wait-for-connection=false sync=false",
                            in_pipeline_quotes(output.socket.string())),
                format, std::nullopt);
          }};
}

OutputTarget target(const DisplayOutput&) {
  return {"display", Reopening::possible, [](const SinkFormat& format) {
            return open_sink("videoconvert ! autovideosink sync=false", format, std::nullopt);
          }};
}

}  // namespace

OutputTarget target_of(const OutputSettings& settings) {
  return std::visit([](const auto& output) { return target(output); }, settings);
}

}  // namespace gimbal
