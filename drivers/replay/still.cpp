#include "drivers/replay/still.hpp"

#include <fmt/format.h>
#include <gst/app/gstappsrc.h>

#include <algorithm>
#include <string>

#include "pipeline/gstreamer/gst_frames.hpp"
#include "pipeline/gstreamer/gst_messages.hpp"

namespace gimbal {
namespace {

constexpr GstClockTime kPatience = 30 * GST_SECOND;

/// Raw format before the encoder, and the encoder. A JPEG file is BT.601 in full range (JFIF),
/// which the encoder takes for granted.
Result<std::string> encoder_for(const std::filesystem::path& path, ImageSize size) {
  const std::string shape = fmt::format("width={},height={}", size.width, size.height);
  if (path.extension() == ".jpg" || path.extension() == ".jpeg") {
    return fmt::format("video/x-raw,format=I420,colorimetry=1:4:7:1,{} ! jpegenc quality=90",
                       shape);
  }
  if (path.extension() == ".png") {
    return fmt::format("video/x-raw,format=RGB,{} ! pngenc", shape);
  }
  return bad_input(fmt::format("{}: pictures are written as .jpg or .png", path.string()));
}

ImageSize scaled(ImageSize size, std::optional<int> width) {
  if (!width || *width <= 0) {
    return size;
  }
  const std::int64_t old_width = size.width;
  const auto height = (2 * std::int64_t{size.height} * *width + old_width) / (2 * old_width);
  return {*width, std::max(1, static_cast<int>(height))};
}

void feed(const GstPipelinePtr& pipeline, const VideoFrame& frame) {
  const GstElementPtr source = element_named(pipeline, "picture");
  const GstCapsPtr caps = nv12_caps(frame.size, 0, frame.color);
  g_object_set(source.get(), "caps", caps.get(), "format", GST_FORMAT_TIME, nullptr);
  GstBufferPtr buffer = wrap_frame(frame);
  GST_BUFFER_PTS(buffer.get()) = 0;
  gst_app_src_push_buffer(GST_APP_SRC(source.get()), buffer.release());
  gst_app_src_end_of_stream(GST_APP_SRC(source.get()));
}

Result<void> run_to_end(const GstPipelinePtr& pipeline, const std::filesystem::path& path) {
  const GstBusPtr bus(gst_element_get_bus(pipeline.get()));
  gst_element_set_state(pipeline.get(), GST_STATE_PLAYING);
  constexpr auto kLast = static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  const GstMessagePtr message(gst_bus_timed_pop_filtered(bus.get(), kPatience, kLast));
  if (!message) {
    return failed(fmt::format("{}: GStreamer does not finish the picture", path.string()));
  }
  if (GST_MESSAGE_TYPE(message.get()) == GST_MESSAGE_ERROR) {
    return bad_input(fmt::format("{}: {}", path.string(), message_text(message.get())));
  }
  return {};
}

}  // namespace

Result<void> write_still(const VideoFrame& frame, const std::filesystem::path& path,
                         std::optional<int> width) {
  if (auto started = init_gstreamer(); !started) {
    return started;
  }
  const auto encoder = encoder_for(path, scaled(frame.size, width));
  if (!encoder) {
    return tl::unexpected(encoder.error());
  }
  const auto pipeline = parse_pipeline(fmt::format(
      "appsrc name=picture ! videoconvert ! videoscale ! {} ! filesink name=file", *encoder));
  if (!pipeline) {
    return tl::unexpected(pipeline.error());
  }
  const GstElementPtr file = element_named(*pipeline, "file");
  g_object_set(file.get(), "location", path.c_str(), nullptr);
  feed(*pipeline, frame);
  return run_to_end(*pipeline, path);
}

}  // namespace gimbal
