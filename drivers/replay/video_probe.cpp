#include "drivers/replay/video_probe.hpp"

#include <fmt/format.h>
#include <gst/video/video.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>

#include "pipeline/gstreamer/gst_messages.hpp"
#include "pipeline/gstreamer/gst_runtime.hpp"

namespace gimbal {
namespace {

constexpr GstClockTime kPollInterval = 100 * GST_MSECOND;
constexpr int kPatiencePolls = 100;
/// Threads come and go while the file's streams are found out.
constexpr int kPatiencePollsWithoutThreads = 5;

/// What passes by while the file is read, noted by GStreamer's threads.
struct Scan {
  std::atomic<std::uint64_t> buffers = 0;  ///< of any stream
  std::mutex mutex;                        ///< guards what follows
  GstPadPtr video;
  GstCapsPtr video_caps;
  bool has_audio = false;
  std::int64_t frame_count = 0;
  std::vector<SensorDuration> frame_times;
};

bool is_media(const GstCaps* caps, std::string_view kind) {
  return std::string_view(gst_structure_get_name(gst_caps_get_structure(caps, 0)))
      .starts_with(kind);
}

GstPadProbeReturn note_buffer(GstPad* /*pad*/, GstPadProbeInfo* /*info*/, gpointer data) {
  ++static_cast<Scan*>(data)->buffers;
  return GST_PAD_PROBE_OK;
}

std::optional<SensorDuration> presentation_time(GstPad* pad, GstBuffer* buffer) {
  GstEvent* event = gst_pad_get_sticky_event(pad, GST_EVENT_SEGMENT, 0);
  if (event == nullptr) {
    return std::nullopt;
  }
  const GstSegment* segment = nullptr;
  gst_event_parse_segment(event, &segment);
  guint64 time = 0;
  const int sign = GST_BUFFER_PTS_IS_VALID(buffer)
                       ? gst_segment_to_running_time_full(segment, GST_FORMAT_TIME,
                                                          GST_BUFFER_PTS(buffer), &time)
                       : 0;
  gst_event_unref(event);
  return sign == 0 ? std::nullopt
                   : std::optional(SensorDuration(sign * static_cast<std::int64_t>(time)));
}

GstPadProbeReturn note_picture(GstPad* pad, GstPadProbeInfo* info, gpointer data) {
  auto& scan = *static_cast<Scan*>(data);
  const std::lock_guard lock(scan.mutex);
  if (!scan.video_caps) {
    scan.video_caps.reset(gst_pad_get_current_caps(pad));
  }
  ++scan.frame_count;
  if (const auto time = presentation_time(pad, GST_PAD_PROBE_INFO_BUFFER(info))) {
    scan.frame_times.push_back(*time);
  }
  return GST_PAD_PROBE_OK;
}

void note_stream(Scan& scan, GstPad* pad) {
  const GstCapsPtr caps(gst_pad_query_caps(pad, nullptr));
  const std::lock_guard lock(scan.mutex);
  if (is_media(caps.get(), "audio/")) {
    scan.has_audio = true;
  } else if (!scan.video && (is_media(caps.get(), "video/") || is_media(caps.get(), "image/"))) {
    scan.video.reset(GST_PAD(gst_object_ref(pad)));
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, note_picture, &scan, nullptr);
  }
}

void take_stream(GstElement* parser, GstPad* pad, gpointer data) {
  auto& scan = *static_cast<Scan*>(data);
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, note_buffer, &scan, nullptr);
  note_stream(scan, pad);
  GstElement* end = gst_element_factory_make("fakesink", nullptr);
  g_object_set(end, "sync", FALSE, "async", FALSE, "enable-last-sample", FALSE, nullptr);
  const GstElementPtr pipeline(GST_ELEMENT(gst_element_get_parent(parser)));
  gst_bin_add(GST_BIN(pipeline.get()), end);
  const GstPadPtr target(gst_element_get_static_pad(end, "sink"));
  gst_pad_link(pad, target.get());
  gst_element_sync_state_with_parent(end);
}

/// Until the end, an error (returned as text) or a standstill.
std::string run_to_end(const GstPipelinePtr& pipeline, const Scan& scan) {
  const GstBusPtr bus(gst_element_get_bus(pipeline.get()));
  gst_element_set_state(pipeline.get(), GST_STATE_PLAYING);
  constexpr auto kLast = static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  std::uint64_t buffers_before = 0;
  for (int idle_polls = 0; idle_polls < kPatiencePolls; ++idle_polls) {
    const GstMessagePtr message(gst_bus_timed_pop_filtered(bus.get(), kPollInterval, kLast));
    if (message) {
      return GST_MESSAGE_TYPE(message.get()) == GST_MESSAGE_ERROR ? message_text(message.get())
                                                                  : "";
    }
    if (scan.buffers != buffers_before) {
      buffers_before = scan.buffers;
      idle_polls = 0;
    }
    if (idle_polls >= kPatiencePollsWithoutThreads && !is_streaming(pipeline)) {
      return "it is cut short or broken";
    }
  }
  return fmt::format("nothing came for {} s", kPatiencePolls * kPollInterval / GST_SECOND);
}

double mean_rate(const std::vector<SensorDuration>& times) {
  if (times.size() < 2 || times.back() == times.front()) {
    return 0;
  }
  return static_cast<double>(times.size() - 1) / to_seconds(times.back() - times.front());
}

VideoInfo summary(Scan& scan, std::string damage) {
  VideoInfo info;
  const GstStructure* caps = gst_caps_get_structure(scan.video_caps.get(), 0);
  gst_structure_get_int(caps, "width", &info.size.width);
  gst_structure_get_int(caps, "height", &info.size.height);
  info.frame_count = scan.frame_count;
  info.has_audio = scan.has_audio;
  info.damage = std::move(damage);
  if (std::ssize(scan.frame_times) == scan.frame_count) {
    info.frame_times = std::move(scan.frame_times);
    std::sort(info.frame_times.begin(), info.frame_times.end());  // B-frames are coded out of order
  }
  gint numerator = 0;
  gint denominator = 0;
  gst_structure_get_fraction(caps, "framerate", &numerator, &denominator);
  info.fps = numerator > 0 && denominator > 0 ? static_cast<double>(numerator) / denominator
                                              : mean_rate(info.frame_times);
  return info;
}

}  // namespace

Result<VideoInfo> probe_video(const std::filesystem::path& path) {
  if (auto started = init_gstreamer(); !started) {
    return tl::unexpected(started.error());
  }
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    return bad_input(fmt::format("{}: no such video file", path.string()));
  }
  Scan scan;
  auto pipeline = parse_pipeline("filesrc name=file ! parsebin name=parser");
  if (!pipeline) {
    return tl::unexpected(pipeline.error());
  }
  const GstElementPtr file = element_named(*pipeline, "file");
  g_object_set(file.get(), "location", path.c_str(), nullptr);
  const GstElementPtr parser = element_named(*pipeline, "parser");
  g_signal_connect(parser.get(), "pad-added", G_CALLBACK(take_stream), &scan);
  std::string damage = run_to_end(*pipeline, scan);
  pipeline->reset();  // its threads are done with the scan then
  if (scan.frame_count == 0) {
    return bad_input(
        fmt::format("{}: holds no video{}", path.string(), damage.empty() ? "" : ": " + damage));
  }
  return summary(scan, std::move(damage));
}

}  // namespace gimbal
