#include "drivers/replay/video_decoder.hpp"

#include <fmt/format.h>
#include <gst/app/gstappsink.h>
#include <gst/pbutils/pbutils.h>

#include <string_view>
#include <utility>

#include "pipeline/gstreamer/gst_frames.hpp"
#include "pipeline/gstreamer/gst_messages.hpp"

namespace gimbal {
namespace {

constexpr auto kPollInterval = std::chrono::milliseconds(50);
/// Threads come and go while the file's streams are found out.
constexpr auto kPatienceWithoutThreads = std::chrono::milliseconds(500);
/// What was decoded before an error still comes; GStreamer says no more when it has all come.
constexpr auto kPatienceAfterFailure = std::chrono::seconds(2);

constexpr const char* kPipeline =
    "filesrc name=file ! decodebin name=decoder "
    "videoconvert name=convert ! appsink name=pictures caps=video/x-raw,format={NV12,I420} "
    "sync=false max-buffers=2 enable-last-sample=false";

std::string_view media_type(const GstCaps* caps) {
  return gst_structure_get_name(gst_caps_get_structure(caps, 0));
}

/// Audio and data stay as they are: their decoders may be missing and are not needed.
gboolean wants_decoding(GstElement* /*decoder*/, GstPad* /*pad*/, GstCaps* caps,
                        gpointer /*data*/) {
  const std::string_view type = media_type(caps);
  const bool is_other =
      type.starts_with("audio/") || type.starts_with("text/") || type.starts_with("meta/");
  return is_other ? FALSE : TRUE;
}

void link_first_video(GstElement* /*decoder*/, GstPad* pad, gpointer convert) {
  const GstPadPtr target(gst_element_get_static_pad(static_cast<GstElement*>(convert), "sink"));
  const GstCapsPtr caps(gst_pad_query_caps(pad, nullptr));
  if (!gst_pad_is_linked(target.get()) && media_type(caps.get()) == "video/x-raw") {
    gst_pad_link(pad, target.get());
  }
}

void note_all_streams_known(GstElement* /*decoder*/, gpointer flag) {
  *static_cast<std::atomic<bool>*>(flag) = true;
}

/// Lets decoders hand over their own padded pictures instead of copying them into packed ones.
GstPadProbeReturn accept_strides(GstPad* /*pad*/, GstPadProbeInfo* info, gpointer /*data*/) {
  GstQuery* query = GST_PAD_PROBE_INFO_QUERY(info);
  if (GST_QUERY_TYPE(query) != GST_QUERY_ALLOCATION) {
    return GST_PAD_PROBE_OK;
  }
  gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
  return GST_PAD_PROBE_HANDLED;
}

}  // namespace

std::optional<SensorDuration> media_time_of(GstSample* picture) {
  const GstClockTime stamp = GST_BUFFER_PTS(gst_sample_get_buffer(picture));
  guint64 time = 0;
  const int sign = gst_segment_to_running_time_full(gst_sample_get_segment(picture),
                                                    GST_FORMAT_TIME, stamp, &time);
  if (!GST_CLOCK_TIME_IS_VALID(stamp) || sign == 0) {
    return std::nullopt;
  }
  return SensorDuration(sign * static_cast<std::int64_t>(time));
}

VideoDecoder::VideoDecoder(std::filesystem::path path, std::chrono::milliseconds patience)
    : path_(std::move(path)), patience_(patience) {}

Result<std::unique_ptr<VideoDecoder>> VideoDecoder::open(const std::filesystem::path& path,
                                                         std::chrono::milliseconds patience) {
  if (auto started = init_gstreamer(); !started) {
    return tl::unexpected(started.error());
  }
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    return bad_input(fmt::format("{}: no such video file", path.string()));
  }
  std::unique_ptr<VideoDecoder> decoder(new VideoDecoder(path, patience));
  if (auto started = decoder->start(); !started) {
    return tl::unexpected(started.error());
  }
  return decoder;
}

Result<void> VideoDecoder::start() {
  auto pipeline = parse_pipeline(kPipeline);
  if (!pipeline) {
    return tl::unexpected(pipeline.error());
  }
  pipeline_ = *std::move(pipeline);
  sink_ = element_named(pipeline_, "pictures");
  g_object_set(element_named(pipeline_, "file").get(), "location", path_.c_str(), nullptr);
  const GstElementPtr decoder = element_named(pipeline_, "decoder");
  const GstElementPtr convert = element_named(pipeline_, "convert");
  g_signal_connect(decoder.get(), "autoplug-continue", G_CALLBACK(wants_decoding), nullptr);
  g_signal_connect(decoder.get(), "pad-added", G_CALLBACK(link_first_video), convert.get());
  g_signal_connect(decoder.get(), "no-more-pads", G_CALLBACK(note_all_streams_known),
                   &are_streams_known_);
  const GstPadPtr pad(gst_element_get_static_pad(sink_.get(), "sink"));
  gst_pad_add_probe(pad.get(), GST_PAD_PROBE_TYPE_QUERY_DOWNSTREAM, accept_strides, nullptr,
                    nullptr);
  conversions_.watch(pipeline_.get());
  gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING);
  auto first = pull();
  if (!first) {
    return tl::unexpected(first.error());
  }
  if (*first == nullptr) {
    return tl::unexpected(no_picture());
  }
  caps_.reset(gst_caps_ref(gst_sample_get_caps(first->get())));
  first_ = *std::move(first);
  first_time_ = media_time_of(first_.get());
  return {};
}

Result<bool> VideoDecoder::rewind() {
  constexpr auto kExactly = static_cast<GstSeekFlags>(GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE);
  if (failure_ || !gst_element_seek_simple(pipeline_.get(), GST_FORMAT_TIME, kExactly, 0)) {
    return false;
  }
  first_.reset();
  auto first = pull();
  if (!first) {
    return tl::unexpected(first.error());
  }
  first_ = *std::move(first);
  return first_ != nullptr && media_time_of(first_.get()) == first_time_;
}

Result<GstSamplePtr> VideoDecoder::next() {
  if (is_interrupted_) {
    return GstSamplePtr();
  }
  if (first_) {
    return std::exchange(first_, nullptr);
  }
  return pull();
}

void VideoDecoder::interrupt() {
  is_interrupted_ = true;
  gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
}

Result<GstSamplePtr> VideoDecoder::pull() {
  constexpr auto kPollNanoseconds = std::chrono::nanoseconds(kPollInterval).count();
  for (auto waited = kPollInterval;; waited += kPollInterval) {
    GstSamplePtr sample(gst_app_sink_try_pull_sample(GST_APP_SINK(sink_.get()),
                                                     static_cast<GstClockTime>(kPollNanoseconds)));
    if (sample || is_interrupted_) {
      return sample;
    }
    drain_bus();
    if (is_at_end() || (failure_ && waited >= kPatienceAfterFailure)) {
      return GstSamplePtr();
    }
    if (waited >= kPatienceWithoutThreads && !is_streaming(pipeline_)) {
      note_failure("it is cut short or broken");
    } else if (waited >= patience_) {
      return failed(fmt::format("{}: no picture came for {} s", path_.string(),
                                std::chrono::duration<double>(patience_).count()));
    }
  }
}

bool VideoDecoder::is_at_end() const {
  const bool has_ended = gst_app_sink_is_eos(GST_APP_SINK(sink_.get())) != FALSE;
  return has_ended || (failure_ && !caps_) || (are_streams_known_ && !has_video());
}

bool VideoDecoder::has_video() const {
  const GstPadPtr pad(
      gst_element_get_static_pad(element_named(pipeline_, "convert").get(), "sink"));
  return gst_pad_is_linked(pad.get()) != FALSE;
}

void VideoDecoder::drain_bus() {
  const GstBusPtr bus(gst_element_get_bus(pipeline_.get()));
  while (const GstMessagePtr message{gst_bus_pop(bus.get())}) {
    if (gst_is_missing_plugin_message(message.get())) {
      missing_plugin_ = missing_plugin_text(message.get());
    } else if (GST_MESSAGE_TYPE(message.get()) == GST_MESSAGE_ERROR) {
      note_failure(message_text(message.get()));
    }
  }
}

/// The first one counts; what follows is its consequence.
void VideoDecoder::note_failure(std::string text) {
  if (!failure_) {
    failure_ = std::move(text);
    warnings_.push_back(fmt::format("{}: damaged: {}", path_.string(), *failure_));
  }
}

Error VideoDecoder::no_picture() const {
  if (!missing_plugin_.empty()) {
    return {Error::Kind::bad_input, fmt::format("{}: {}", path_.string(), missing_plugin_)};
  }
  if (are_streams_known_ && !has_video()) {
    return {Error::Kind::bad_input, fmt::format("{}: holds no video", path_.string())};
  }
  return {Error::Kind::bad_input, fmt::format("{}: no picture can be decoded from it{}",
                                              path_.string(), failure_ ? ": " + *failure_ : "")};
}

}  // namespace gimbal
