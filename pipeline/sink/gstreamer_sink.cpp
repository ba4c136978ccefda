#include "pipeline/sink/gstreamer_sink.hpp"

#include <fmt/format.h>
#include <gst/app/gstappsrc.h>

#include <atomic>
#include <utility>

#include "pipeline/gstreamer/gst_frames.hpp"
#include "pipeline/gstreamer/gst_messages.hpp"

namespace gimbal {
namespace {

/// Enough to keep an encoder busy while the next frame is drawn; more would only cost memory.
constexpr std::size_t kQueuedFrames = 4;

GstPadProbeReturn note_data(GstPad* /*pad*/, GstPadProbeInfo* /*info*/, gpointer user_data) {
  static_cast<StreamProgress*>(user_data)->data_arrived();
  return GST_PAD_PROBE_OK;
}

void watch_sink(const GValue* item, gpointer user_data) {
  auto* element = static_cast<GstElement*>(g_value_get_object(item));
  const GstPadPtr pad(gst_element_get_static_pad(element, "sink"));
  if (pad) {
    constexpr auto kData =
        static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_BUFFER_LIST);
    gst_pad_add_probe(pad.get(), kData, note_data, user_data, nullptr);
  }
}

/// Whether what follows the pad respects GstVideoMeta, or takes any buffer for a packed picture.
bool consumer_knows_strides(GstPad* pad) {
  const GstCapsPtr caps(gst_pad_get_current_caps(pad));
  GstQuery* query = gst_query_new_allocation(caps.get(), FALSE);
  const bool is_known = gst_pad_peer_query(pad, query) != FALSE &&
                        gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
  gst_query_unref(query);
  return is_known;
}

/// Whether the picture lies as GStreamer lays out NV12 by default.
bool is_packed(GstBuffer* buffer, const GstVideoInfo& info) {
  const GstVideoMeta* meta = gst_buffer_get_video_meta(buffer);
  bool is_same = gst_buffer_get_size(buffer) == GST_VIDEO_INFO_SIZE(&info);
  for (guint plane = 0; plane < GST_VIDEO_INFO_N_PLANES(&info); ++plane) {
    is_same = is_same && meta->offset[plane] == GST_VIDEO_INFO_PLANE_OFFSET(&info, plane) &&
              meta->stride[plane] == GST_VIDEO_INFO_PLANE_STRIDE(&info, plane);
  }
  return is_same;
}

/// A copy in the layout that GStreamer gives to NV12 by default.
GstBuffer* repacked(GstBuffer* buffer, const GstVideoInfo& info) {
  GstBuffer* packed = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info), nullptr);
  gst_buffer_copy_into(packed, buffer, GST_BUFFER_COPY_TIMESTAMPS, 0, static_cast<gsize>(-1));
  GstVideoFrame from;
  GstVideoFrame to;
  if (gst_video_frame_map(&from, &info, buffer, GST_MAP_READ)) {
    if (gst_video_frame_map(&to, &info, packed, GST_MAP_WRITE)) {
      gst_video_frame_copy(&to, &from);
      gst_video_frame_unmap(&to);
    }
    gst_video_frame_unmap(&from);
  }
  return packed;
}

}  // namespace

struct GstreamerSink::FrameGate {
  StreamProgress& progress;
  GstVideoInfo info;
  std::optional<bool> knows_strides;
  std::atomic<std::int64_t> bytes_repacked = 0;

  static GstPadProbeReturn on_frame(GstPad* pad, GstPadProbeInfo* probe, gpointer user_data) {
    auto& gate = *static_cast<FrameGate*>(user_data);
    if (!gate.knows_strides) {
      gate.knows_strides = consumer_knows_strides(pad);
    }
    GstBuffer* frame = GST_PAD_PROBE_INFO_BUFFER(probe);
    if (!*gate.knows_strides && !is_packed(frame, gate.info)) {
      GST_PAD_PROBE_INFO_DATA(probe) = repacked(frame, gate.info);
      gst_buffer_unref(frame);
      gate.bytes_repacked += static_cast<std::int64_t>(GST_VIDEO_INFO_SIZE(&gate.info));
    }
    gate.progress.frame_taken();
    return GST_PAD_PROBE_OK;
  }
};

GstreamerSink::GstreamerSink(SinkPipeline target, const SinkFormat& format)
    : format_(format),
      remains_(std::move(target.remains)),
      warnings_(std::move(target.warnings)),
      audio_(std::move(target.audio)),
      progress_(target.patience),
      source_(element_named(target.pipeline, kFrameSourceName)),
      pipeline_(std::move(target.pipeline)) {
  const GstCapsPtr caps = nv12_caps(format_.size, format_.fps, format_.color);
  gate_.reset(new FrameGate{progress_, {}, std::nullopt});
  gst_video_info_from_caps(&gate_->info, caps.get());
  // Waiting is ours: an appsrc that blocks does not wake up when the pipeline fails.
  g_object_set(source_.get(), "caps", caps.get(), "format", GST_FORMAT_TIME, "max-bytes",
               guint64{0}, nullptr);
  if (format_.live) {
    follow_the_clock(*format_.live);
  }
}

/// The pipeline's running time is since the first picture was taken, for live audio beside the
/// pictures as well.
void GstreamerSink::follow_the_clock(const LiveTiming& live) {
  g_object_set(source_.get(), "is-live", TRUE, "min-latency", gint64{live.delay.count()}, nullptr);
  const GstClockPtr clock(gst_system_clock_obtain());
  gst_pipeline_use_clock(GST_PIPELINE(pipeline_.get()), clock.get());
  gst_element_set_start_time(pipeline_.get(), GST_CLOCK_TIME_NONE);
  gst_element_set_base_time(pipeline_.get(),
                            static_cast<GstClockTime>(live.first.time_since_epoch().count()));
}

GstreamerSink::~GstreamerSink() = default;

Result<std::unique_ptr<FrameSink>> GstreamerSink::start(SinkPipeline target,
                                                        const SinkFormat& format) {
  std::unique_ptr<GstreamerSink> sink(new GstreamerSink(std::move(target), format));
  sink->watch();
  const auto change = gst_element_set_state(sink->pipeline_.get(), GST_STATE_PLAYING);
  if (change == GST_STATE_CHANGE_FAILURE) {
    auto state = sink->progress_.state();
    return bad_input(state ? "the GStreamer pipeline does not start" : state.error().message);
  }
  return std::unique_ptr<FrameSink>(std::move(sink));
}

GstBusSyncReply GstreamerSink::on_message(GstBus* /*bus*/, GstMessage* message, gpointer sink) {
  auto& self = *static_cast<GstreamerSink*>(sink);
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS) {
    self.progress_.ended();
  } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR &&
             !(self.audio_ && self.audio_->takes_error(message))) {
    self.progress_.failed_with(message_text(message));
  }
  gst_message_unref(message);
  return GST_BUS_DROP;
}

void GstreamerSink::watch() {
  const GstBusPtr bus(gst_element_get_bus(pipeline_.get()));
  gst_bus_set_sync_handler(bus.get(), on_message, this, nullptr);
  const GstPadPtr pad(gst_element_get_static_pad(source_.get(), "src"));
  gst_pad_add_probe(pad.get(), GST_PAD_PROBE_TYPE_BUFFER, FrameGate::on_frame, gate_.get(),
                    nullptr);
  GstIterator* sinks = gst_bin_iterate_sinks(GST_BIN(pipeline_.get()));
  gst_iterator_foreach(sinks, watch_sink, &progress_);
  gst_iterator_free(sinks);
  conversions_.watch(pipeline_.get());
}

Result<void> GstreamerSink::check(const VideoFrame& frame) const {
  const int extra_columns = frame.size.width - format_.size.width;
  const int extra_rows = frame.size.height - format_.size.height;
  if (extra_columns < 0 || extra_columns > 1 || extra_rows < 0 || extra_rows > 1) {
    return failed(fmt::format("frame {} is {}x{}, but the output was opened for {}x{}",
                              frame.stamp.index, frame.size.width, frame.size.height,
                              format_.size.width, format_.size.height));
  }
  if (first_time_ && frame.stamp.time <= last_time_) {
    return failed(fmt::format("the stamp of frame {} does not rise: {:.9f} s after {:.9f} s",
                              frame.stamp.index, seconds_since_epoch(frame.stamp.time),
                              seconds_since_epoch(last_time_)));
  }
  return {};
}

SensorDuration GstreamerSink::shown_for(const VideoFrame& frame) const {
  constexpr double kUsualFps = 30;
  if (format_.fps > 0) {
    return duration_from_seconds(1 / format_.fps);
  }
  return first_time_ ? frame.stamp.time - last_time_ : duration_from_seconds(1 / kUsualFps);
}

Result<void> GstreamerSink::write(const VideoFrame& frame) {
  if (auto checked = check(frame); !checked) {
    return explain(checked);
  }
  if (auto room = progress_.wait_for_room(kQueuedFrames); !room) {
    return explain(room);
  }
  const SensorDuration duration = shown_for(frame);
  first_time_ = first_time_.value_or(format_.live ? format_.live->first : frame.stamp.time);
  last_time_ = frame.stamp.time;
  VideoFrame visible = frame;
  visible.size = format_.size;
  GstBufferPtr buffer = wrap_frame(visible);
  GST_BUFFER_PTS(buffer.get()) = static_cast<GstClockTime>((last_time_ - *first_time_).count());
  GST_BUFFER_DURATION(buffer.get()) = static_cast<GstClockTime>(duration.count());
  progress_.frame_queued();
  if (gst_app_src_push_buffer(GST_APP_SRC(source_.get()), buffer.release()) != GST_FLOW_OK) {
    progress_.failed_with("the GStreamer pipeline takes no more pictures");
  }
  return explain(progress_.state());
}

/// Live sound has no end of its own, and a muxer waits for it.
void GstreamerSink::end_other_sources() {
  const auto end = [](const GValue* item, gpointer ours) {
    auto* source = static_cast<GstElement*>(g_value_get_object(item));
    if (source != ours) {
      gst_element_send_event(source, gst_event_new_eos());
    }
  };
  GstIterator* sources = gst_bin_iterate_sources(GST_BIN(pipeline_.get()));
  gst_iterator_foreach(sources, end, source_.get());
  gst_iterator_free(sources);
}

Result<void> GstreamerSink::finish() {
  gst_app_src_end_of_stream(GST_APP_SRC(source_.get()));
  if (format_.live) {
    end_other_sources();
  }
  // What an element says while it is taken down, as shmsink does, is no failure: all is written.
  auto written = progress_.wait_for_end().and_then([this] { return progress_.state(); });
  gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
  return explain(std::move(written));
}

std::optional<std::int64_t> GstreamerSink::bytes_copied() const {
  return gate_->bytes_repacked + conversions_.bytes();
}

std::vector<std::string> GstreamerSink::warnings() const {
  std::vector<std::string> warnings = warnings_;
  if (audio_ && audio_->has_failed()) {
    warnings.emplace_back("the recording's audio could not be read to its end");
  }
  return warnings;
}

Result<void> GstreamerSink::explain(Result<void> result) const {
  if (!result && !remains_.empty()) {
    return failed(fmt::format("{}; {}", result.error().message, remains_));
  }
  return result;
}

}  // namespace gimbal
