#include "pipeline/sink/video_encoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/gstreamer/gst_messages.hpp"
#include "pipeline/gstreamer/gst_runtime.hpp"

namespace gimbal {
namespace {

double usual_fps(const SinkFormat& format) {
  return format.fps > 0 ? format.fps : 30;
}

/// For encoders that have no constant quality: enough for detail in motion, 8 Mbit/s for 1280x720
/// at 30 pictures a second.
int bits_per_second(const SinkFormat& format) {
  constexpr double kBitsPerPixel = 0.3;
  return static_cast<int>(kBitsPerPixel * format.size.width * format.size.height *
                          usual_fps(format));
}

int pictures_a_second(const SinkFormat& format) {
  return std::max(1, static_cast<int>(std::lround(usual_fps(format))));
}

VideoEncoder openh264_encoder(const SinkFormat& format) {
  return {"openh264enc",
          fmt::format("openh264enc rate-control=bitrate bitrate={} complexity=high ! h264parse",
                      bits_per_second(format))};
}

/// What a board has for it, which leaves the processor to the warp. The level must be named: the
/// kernel's default is too low for the driver to start with 1080p.
VideoEncoder board_encoder(const SinkFormat& format) {
  return {"v4l2h264enc", fmt::format("v4l2h264enc extra-controls=\"controls,video_bitrate={}\" "
                                     "! video/x-h264,level=(string)4 ! h264parse",
                                     bits_per_second(format))};
}

Result<VideoEncoder> first_installed(const std::vector<VideoEncoder>& encoders) {
  if (auto started = init_gstreamer(); !started) {
    return tl::unexpected(started.error());
  }
  for (const VideoEncoder& encoder : encoders) {
    if (is_element_installed(encoder.element)) {
      return encoder;
    }
  }
  return bad_input(fmt::format("no H.264 encoder: {}", missing_element_text("x264enc")));
}

}  // namespace

SinkFormat with_even_size(SinkFormat format) {
  format.size = {format.size.width / 2 * 2, format.size.height / 2 * 2};
  return format;
}

std::vector<VideoEncoder> video_encoders(const SinkFormat& format) {
  return {
      // Without vbv-buf-capacity=0 the element caps the quality asked for at its default bit rate.
      {"x264enc",
       "x264enc pass=qual quantizer=20 speed-preset=veryfast bframes=0 vbv-buf-capacity=0"},
      openh264_encoder(format),
      board_encoder(format),
  };
}

Result<VideoEncoder> choose_video_encoder(const SinkFormat& format) {
  return first_installed(video_encoders(format));
}

Result<VideoEncoder> choose_recording_encoder(const SinkFormat& format) {
  return first_installed({
      board_encoder(format),
      {"x264enc", fmt::format("x264enc tune=zerolatency pass=qual quantizer=18 "
                              "speed-preset=ultrafast bframes=0 vbv-buf-capacity=0 key-int-max={}",
                              pictures_a_second(format))},
      openh264_encoder(format),
  });
}

Result<VideoEncoder> choose_stream_encoder(const SinkFormat& format, int bitrate_kbps) {
  return first_installed({
      {"v4l2h264enc",
       fmt::format("v4l2h264enc "
                   "extra-controls=\"controls,video_bitrate={},h264_i_frame_period={},"
                   "repeat_sequence_header=1\" ! video/x-h264,level=(string)4",
                   1000 * bitrate_kbps, pictures_a_second(format))},
      {"x264enc", fmt::format("x264enc tune=zerolatency speed-preset=superfast bitrate={} "
                              "key-int-max={} bframes=0",
                              bitrate_kbps, pictures_a_second(format))},
      {"openh264enc",
       fmt::format("openh264enc rate-control=bitrate usage-type=camera bitrate={} gop-size={}",
                   1000 * bitrate_kbps, pictures_a_second(format))},
  });
}

}  // namespace gimbal
