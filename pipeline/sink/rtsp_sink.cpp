#include "pipeline/sink/rtsp_sink.hpp"

#include <fmt/format.h>
#include <gst/app/gstappsrc.h>
#include <gst/rtsp-server/rtsp-server.h>

#include <mutex>
#include <thread>
#include <utility>

#include "pipeline/gstreamer/gst_frames.hpp"
#include "pipeline/gstreamer/gst_messages.hpp"
#include "pipeline/gstreamer/gst_runtime.hpp"
#include "pipeline/sink/gstreamer_sink.hpp"
#include "pipeline/sink/video_encoder.hpp"

namespace gimbal {
namespace {

/// What an encoder has not taken by then is too old to be seen.
constexpr guint64 kQueuedFrames = 4;

struct GLibUnref {
  void operator()(GMainLoop* loop) const { g_main_loop_unref(loop); }
  void operator()(GMainContext* context) const { g_main_context_unref(context); }
  void operator()(gpointer object) const { g_object_unref(object); }
};
template <typename T>
using GLibPtr = std::unique_ptr<T, GLibUnref>;

/// Between brackets, as the server wants it: what has to be sent carries pay0 and pay1 for names.
std::string media_text(const RtspSettings& settings, const VideoEncoder& encoder) {
  const std::string video = fmt::format(
      "appsrc name={} ! videoconvert ! {} ! rtph264pay name=pay0 pt=96 config-interval=-1",
      kFrameSourceName, encoder.text);
  if (settings.audio.empty()) return fmt::format("( {} )", video);
  return fmt::format(
      "( {} {} ! audioconvert ! audioresample ! opusenc ! rtpopuspay name=pay1 pt=97 )", video,
      settings.audio);
}

/// Presentation time is the capture's on the pipeline's clock. Known only here: the base time is
/// set when the first client's stream begins.
GstPadProbeReturn stamp_frame(GstPad* pad, GstPadProbeInfo* info, gpointer /*data*/) {
  GstBuffer* buffer = GST_PAD_PROBE_INFO_BUFFER(info);
  const GstElementPtr source(gst_pad_get_parent_element(pad));
  const GstClockTime base = gst_element_get_base_time(source.get());
  const GstClockTime taken = GST_BUFFER_OFFSET(buffer);
  if (taken < base) return GST_PAD_PROBE_DROP;
  GST_BUFFER_PTS(buffer) = taken - base;
  GST_BUFFER_OFFSET(buffer) = GST_BUFFER_OFFSET_NONE;
  return GST_PAD_PROBE_OK;
}

/// Where frames go in: shared with the media, which may outlive the sink by a moment.
struct Inlet {
  std::mutex mutex;
  GstElementPtr source;  ///< of the stream that clients share; null while there are none
};

void close_inlet(GstRTSPMedia* /*media*/, gpointer data) {
  Inlet& inlet = **static_cast<std::shared_ptr<Inlet>*>(data);
  const std::lock_guard lock(inlet.mutex);
  inlet.source.reset();
}

void drop_inlet(gpointer data, GClosure* /*closure*/) {
  delete static_cast<std::shared_ptr<Inlet>*>(data);
}

class GstRtspSink final : public RtspSink {
 public:
  GstRtspSink(RtspSettings settings, const SinkFormat& format)
      : settings_(std::move(settings)),
        format_(format),
        context_(g_main_context_new()),
        loop_(g_main_loop_new(context_.get(), FALSE)),
        server_(gst_rtsp_server_new()) {}

  ~GstRtspSink() override { stop(); }

  Result<void> listen(const VideoEncoder& encoder) {
    gst_rtsp_server_set_address(server_.get(), settings_.address.c_str());
    gst_rtsp_server_set_service(server_.get(), fmt::format("{}", settings_.port).c_str());
    mount(encoder);
    GError* error = nullptr;
    GSource* const listening = gst_rtsp_server_create_source(server_.get(), nullptr, &error);
    if (listening == nullptr) {
      return failed(
          fmt::format("rtsp://{}:{}: {}", settings_.address, settings_.port, take_text(error)));
    }
    g_source_attach(listening, context_.get());
    listening_ = listening;
    thread_ = std::thread([this] {
      g_main_context_push_thread_default(context_.get());
      g_main_loop_run(loop_.get());
      g_main_context_pop_thread_default(context_.get());
    });
    return {};
  }

  Result<void> write(const VideoFrame& frame) override {
    const std::lock_guard lock(inlet_->mutex);
    if (!inlet_->source) return {};  // nobody looks
    VideoFrame visible = frame;
    visible.size = format_.size;
    GstBufferPtr buffer = wrap_frame(visible);
    GST_BUFFER_OFFSET(buffer.get()) =
        static_cast<guint64>(frame.stamp.time.time_since_epoch().count());
    // Its failure is the end of a client's stream, not of ours.
    gst_app_src_push_buffer(GST_APP_SRC(inlet_->source.get()), buffer.release());
    return {};
  }

  Result<void> finish() override {
    stop();
    return {};
  }

  [[nodiscard]] std::vector<std::string> warnings() const override { return {}; }

  [[nodiscard]] std::string url() const override {
    return fmt::format("rtsp://{}:{}{}", settings_.address,
                       gst_rtsp_server_get_bound_port(server_.get()), settings_.path);
  }

 private:
  void mount(const VideoEncoder& encoder) {
    GstRTSPMediaFactory* const factory = gst_rtsp_media_factory_new();
    gst_rtsp_media_factory_set_launch(factory, media_text(settings_, encoder).c_str());
    gst_rtsp_media_factory_set_shared(factory, TRUE);
    const GstClockPtr clock(gst_system_clock_obtain());
    gst_rtsp_media_factory_set_clock(factory, clock.get());
    g_signal_connect(factory, "media-configure", G_CALLBACK(on_media), this);
    const GLibPtr<GstRTSPMountPoints> mounts(gst_rtsp_server_get_mount_points(server_.get()));
    gst_rtsp_mount_points_add_factory(mounts.get(), settings_.path.c_str(), factory);
  }

  static void on_media(GstRTSPMediaFactory* /*factory*/, GstRTSPMedia* media, gpointer sink) {
    static_cast<GstRtspSink*>(sink)->begin(media);
  }

  void begin(GstRTSPMedia* media) {
    const GstElementPtr element(gst_rtsp_media_get_element(media));
    GstElementPtr source(gst_bin_get_by_name_recurse_up(GST_BIN(element.get()), kFrameSourceName));
    const GstCapsPtr caps = nv12_caps(format_.size, format_.fps, format_.color);
    g_object_set(source.get(), "caps", caps.get(), "format", GST_FORMAT_TIME, "is-live", TRUE,
                 "min-latency", gint64{format_.live->delay.count()}, "max-bytes", guint64{0},
                 "max-buffers", kQueuedFrames, "leaky-type", GST_APP_LEAKY_TYPE_DOWNSTREAM,
                 nullptr);
    const GstPadPtr pad(gst_element_get_static_pad(source.get(), "src"));
    gst_pad_add_probe(pad.get(), GST_PAD_PROBE_TYPE_BUFFER, stamp_frame, nullptr, nullptr);
    g_signal_connect_data(media, "unprepared", G_CALLBACK(close_inlet),
                          new std::shared_ptr<Inlet>(inlet_), drop_inlet, G_CONNECT_DEFAULT);
    const std::lock_guard lock(inlet_->mutex);
    inlet_->source = std::move(source);
  }

  static GstRTSPFilterResult remove_client(GstRTSPServer* /*server*/, GstRTSPClient* /*client*/,
                                           gpointer /*data*/) {
    return GST_RTSP_FILTER_REMOVE;
  }

  /// From inside the loop: one that does not run yet cannot be told to end.
  void end_loop() {
    GSource* const ending = g_idle_source_new();
    g_source_set_callback(
        ending,
        [](gpointer loop) {
          g_main_loop_quit(static_cast<GMainLoop*>(loop));
          return G_SOURCE_REMOVE;
        },
        loop_.get(), nullptr);
    g_source_attach(ending, context_.get());
    g_source_unref(ending);
  }

  void stop() {
    if (!thread_.joinable()) return;
    gst_rtsp_server_client_filter(server_.get(), remove_client, nullptr);
    g_source_destroy(listening_);
    g_source_unref(listening_);
    end_loop();
    thread_.join();
  }

  const RtspSettings settings_;
  const SinkFormat format_;
  GLibPtr<GMainContext> context_;
  GLibPtr<GMainLoop> loop_;
  GLibPtr<GstRTSPServer> server_;
  GSource* listening_ = nullptr;
  std::thread thread_;
  const std::shared_ptr<Inlet> inlet_ = std::make_shared<Inlet>();
};

}  // namespace

Result<std::unique_ptr<RtspSink>> RtspSink::start(const RtspSettings& settings,
                                                  const SinkFormat& format) {
  if (auto started = init_gstreamer(); !started) return tl::unexpected(started.error());
  const SinkFormat encoded = with_even_size(format);
  const auto encoder = choose_stream_encoder(encoded, settings.bitrate_kbps);
  if (!encoder) return tl::unexpected(encoder.error());
  auto sink = std::make_unique<GstRtspSink>(settings, encoded);
  if (auto listening = sink->listen(*encoder); !listening) {
    return tl::unexpected(listening.error());
  }
  return sink;
}

}  // namespace gimbal
