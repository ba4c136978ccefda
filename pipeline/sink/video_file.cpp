#include "pipeline/sink/video_file.hpp"

#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/gstreamer/gst_messages.hpp"
#include "pipeline/gstreamer/gst_runtime.hpp"
#include "pipeline/sink/gstreamer_sink.hpp"

namespace gimbal {
namespace {

struct Encoder {
  const char* element;
  std::string text;
};

/// Enough that coding is not seen: about 8 Mbit/s for 1280x720 at 30 fps.
int bits_per_second(const SinkFormat& format) {
  constexpr double kBitsPerPixel = 0.3;
  const double fps = format.fps > 0 ? format.fps : 30;
  return static_cast<int>(kBitsPerPixel * format.size.width * format.size.height * fps);
}

/// In order of preference. With a capacity the rate buffer would cap the quality asked of x264.
std::array<Encoder, 3> encoders(const SinkFormat& format) {
  const int bitrate = bits_per_second(format);
  return {{
      {"x264enc",
       "x264enc pass=qual quantizer=20 speed-preset=veryfast bframes=0 vbv-buf-capacity=0"},
      {"openh264enc",
       fmt::format("openh264enc rate-control=bitrate bitrate={} complexity=high ! h264parse",
                   bitrate)},
      {"v4l2h264enc",
       fmt::format("v4l2h264enc extra-controls=\"controls,video_bitrate={}\" "
                   "! video/x-h264,level=(string)4 ! h264parse",
                   bitrate)},
  }};
}

Result<std::string> choose_encoder(const SinkFormat& format) {
  for (const Encoder& encoder : encoders(format)) {
    if (is_element_installed(encoder.element)) {
      return encoder.text;
    }
  }
  return bad_input(fmt::format("no H.264 encoder: {}", missing_element_text("x264enc")));
}

struct Container {
  const char* muxer;
  const char* remains;  ///< of a file whose writing failed
};

Container container_of(const std::filesystem::path& path) {
  if (path.extension() == ".mp4") {
    return {"mp4mux trak-timescale=90000", "is incomplete and will not play"};
  }
  return {"matroskamux timecodescale=100000 max-cluster-duration=3000000000",
          "plays up to the failure only"};
}

ImageSize even(ImageSize size) { return {size.width / 2 * 2, size.height / 2 * 2}; }

}  // namespace

Result<std::unique_ptr<FrameSink>> open_video_file(const std::filesystem::path& path,
                                                   const SinkFormat& format,
                                                   const std::optional<AudioTrack>& audio) {
  static_cast<void>(audio);
  SinkFormat encoded = format;
  encoded.size = even(format.size);
  if (encoded.size.width == 0 || encoded.size.height == 0) {
    return bad_input(fmt::format("{}x{} is too small for a video", format.size.width,
                                 format.size.height));
  }
  auto encoder = choose_encoder(encoded);
  if (!encoder) {
    return tl::unexpected(encoder.error());
  }
  const Container container = container_of(path);
  auto pipeline =
      parse_pipeline(fmt::format("appsrc name={} ! videoconvert ! {} ! {} name=muxer ! filesink name=file",
                                 kFrameSourceName, *encoder, container.muxer));
  if (!pipeline) {
    return tl::unexpected(pipeline.error());
  }
  const GstElementPtr file(gst_bin_get_by_name(GST_BIN(pipeline->get()), "file"));
  g_object_set(file.get(), "location", path.c_str(), nullptr);
  SinkPipeline target;
  target.pipeline = *std::move(pipeline);
  target.remains = fmt::format("{} {}", path.string(), container.remains);
  if (encoded.size != format.size) {
    target.warnings.push_back(fmt::format(
        "{}: H.264 has even sizes only: written as {}x{}, without the last column or row of {}x{}",
        path.string(), encoded.size.width, encoded.size.height, format.size.width,
        format.size.height));
  }
  return GstreamerSink::start(std::move(target), encoded);
}

}  // namespace gimbal
