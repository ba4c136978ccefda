#include "pipeline/sink/video_encoder.hpp"

#include <fmt/format.h>

#include "pipeline/gstreamer/gst_messages.hpp"
#include "pipeline/gstreamer/gst_runtime.hpp"

namespace gimbal {
namespace {

/// For encoders that have no constant quality: enough for detail in motion, 8 Mbit/s for 1280x720
/// at 30 pictures a second.
int bits_per_second(const SinkFormat& format) {
  constexpr double kBitsPerPixel = 0.3;
  const double fps = format.fps > 0 ? format.fps : 30;
  return static_cast<int>(kBitsPerPixel * format.size.width * format.size.height * fps);
}

}  // namespace

std::vector<VideoEncoder> video_encoders(const SinkFormat& format) {
  const int bitrate = bits_per_second(format);
  return {
      // Without vbv-buf-capacity=0 the element caps the quality asked for at its default bit rate.
      {"x264enc",
       "x264enc pass=qual quantizer=20 speed-preset=veryfast bframes=0 vbv-buf-capacity=0"},
      {"openh264enc",
       fmt::format("openh264enc rate-control=bitrate bitrate={} complexity=high ! h264parse",
                   bitrate)},
      // The level must be named: the kernel's default is too low for the driver to start with
      // 1080p.
      {"v4l2h264enc", fmt::format("v4l2h264enc extra-controls=\"controls,video_bitrate={}\" "
                                  "! video/x-h264,level=(string)4 ! h264parse",
                                  bitrate)},
  };
}

Result<VideoEncoder> choose_video_encoder(const SinkFormat& format) {
  for (const VideoEncoder& encoder : video_encoders(format)) {
    if (is_element_installed(encoder.element)) {
      return encoder;
    }
  }
  return bad_input(fmt::format("no H.264 encoder: {}", missing_element_text("x264enc")));
}

}  // namespace gimbal
