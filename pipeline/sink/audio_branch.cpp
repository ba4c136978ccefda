#include "pipeline/sink/audio_branch.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "pipeline/gstreamer/gst_messages.hpp"

namespace gimbal {
namespace {

constexpr GstClockTime kPatience = 5 * GST_SECOND;

std::string_view media_type(const GstCaps* caps) {
  return gst_structure_get_name(gst_caps_get_structure(caps, 0));
}

bool is_audio(const GstCaps* caps) {
  return media_type(caps).starts_with("audio/");
}

/// Caps of the first audio stream in what parsebin says it has; null if there is none.
GstCapsPtr audio_in(GstMessage* collection_message) {
  GstStreamCollection* collection = nullptr;
  gst_message_parse_stream_collection(collection_message, &collection);
  GstCapsPtr caps;
  for (guint i = 0; i < gst_stream_collection_get_size(collection) && !caps; ++i) {
    GstStream* stream = gst_stream_collection_get_stream(collection, i);
    if ((gst_stream_get_stream_type(stream) & GST_STREAM_TYPE_AUDIO) != 0) {
      caps.reset(gst_stream_get_caps(stream));
    }
  }
  gst_object_unref(collection);
  return caps;
}

/// The parser's own list, as a demuxer's may come before it and be incomplete; or an error; or
/// nothing in time.
GstMessagePtr wait_for_streams(const GstPipelinePtr& pipeline) {
  const GstBusPtr bus(gst_element_get_bus(pipeline.get()));
  const GstElementPtr parser = element_named(pipeline, "parser");
  constexpr auto kAnswers =
      static_cast<GstMessageType>(GST_MESSAGE_STREAM_COLLECTION | GST_MESSAGE_ERROR);
  for (;;) {
    GstMessagePtr answer(gst_bus_timed_pop_filtered(bus.get(), kPatience, kAnswers));
    if (!answer || GST_MESSAGE_TYPE(answer.get()) == GST_MESSAGE_ERROR ||
        GST_MESSAGE_SRC(answer.get()) == GST_OBJECT(parser.get())) {
      return answer;
    }
  }
}

/// Caps of the first audio stream as parsed; null if there is none.
Result<GstCapsPtr> find_audio(const std::filesystem::path& file) {
  auto pipeline = parse_pipeline("filesrc name=file ! parsebin name=parser");
  if (!pipeline) {
    return tl::unexpected(pipeline.error());
  }
  g_object_set(element_named(*pipeline, "file").get(), "location", file.c_str(), nullptr);
  gst_element_set_state(pipeline->get(), GST_STATE_PAUSED);
  const GstMessagePtr answer = wait_for_streams(*pipeline);
  if (!answer) {
    return failed("it does not say what streams it has");
  }
  if (GST_MESSAGE_TYPE(answer.get()) == GST_MESSAGE_ERROR) {
    return failed(message_text(answer.get()));
  }
  return audio_in(answer.get());
}

/// Caps of the muxer's audio pads.
GstCapsPtr audio_pad_caps(const char* muxer_element) {
  GstElementFactory* factory = gst_element_factory_find(muxer_element);
  GstCapsPtr caps;
  for (const GList* item = gst_element_factory_get_static_pad_templates(factory); item != nullptr;
       item = item->next) {
    auto* pad = static_cast<GstStaticPadTemplate*>(item->data);
    if (std::string_view(pad->name_template) == "audio_%u") {
      caps.reset(gst_static_caps_get(&pad->static_caps));
    }
  }
  gst_object_unref(factory);
  return caps;
}

bool is_aac(const GstCaps* caps) {
  gint version = 0;
  gst_structure_get_int(gst_caps_get_structure(caps, 0), "mpegversion", &version);
  return media_type(caps) == "audio/mpeg" && (version == 2 || version == 4);
}

bool takes(const char* muxer_element, const GstCapsPtr& audio) {
  GstCapsPtr caps(gst_caps_copy(audio.get()));
  if (is_aac(audio.get())) {  // aacparse gives what the muxer wants
    gst_structure_remove_field(gst_caps_get_structure(caps.get(), 0), "stream-format");
  }
  const GstCapsPtr pad_caps = audio_pad_caps(muxer_element);
  return gst_caps_can_intersect(caps.get(), pad_caps.get()) != FALSE;
}

std::string branch_text(std::string_view conversion) {
  return fmt::format(
      "filesrc name=audio_file ! parsebin name=audio_parser "
      "queue name=audio_entry ! {} ! muxer.audio_0",
      conversion);
}

bool is_within(GstObject* object, const GstElementPtr& element) {
  return element && (object == GST_OBJECT(element.get()) ||
                     gst_object_has_as_ancestor(object, GST_OBJECT(element.get())));
}

AudioPlan plan_for(const AudioTrack& track, const GstCapsPtr& audio, const char* muxer_element) {
  if (takes(muxer_element, audio)) {
    return {branch_text(is_aac(audio.get()) ? "aacparse" : "identity"), ""};
  }
  const std::string_view codec = media_type(audio.get());
  constexpr const char* kAacEncoder = "avenc_aac";
  if (is_element_installed(kAacEncoder)) {
    return {branch_text(fmt::format(
                "decodebin name=audio_decoder ! audioconvert ! audioresample ! {}", kAacEncoder)),
            fmt::format("{}: {} cannot hold its audio ({}) as it is: encoded again as AAC",
                        track.file.string(), muxer_element, codec)};
  }
  return {"",
          fmt::format("{}: {} cannot hold its audio ({}): left out; to encode it again, apt "
                      "install {}",
                      track.file.string(), muxer_element, codec, package_of_element(kAacEncoder))};
}

}  // namespace

bool has_audio(const AudioTrack& track) {
  const auto audio = find_audio(track.file);
  return audio && *audio;
}

AudioPlan plan_audio(const AudioTrack& track, const char* muxer_element) {
  auto audio = find_audio(track.file);
  if (!audio) {
    return {"", fmt::format("{}: its audio is left out: {}", track.file.string(),
                            audio.error().message)};
  }
  return *audio ? plan_for(track, *audio, muxer_element) : AudioPlan{};
}

AudioBranch::AudioBranch(const GstPipelinePtr& pipeline, const AudioTrack& track)
    : offset_(track.offset),
      parser_(element_named(pipeline, "audio_parser")),
      decoder_(element_named(pipeline, "audio_decoder")),
      entry_(gst_element_get_static_pad(element_named(pipeline, "audio_entry").get(), "sink")),
      muxer_pad_(gst_element_get_static_pad(element_named(pipeline, "muxer").get(), "audio_0")) {
  gst_segment_init(&segment_, GST_FORMAT_TIME);
  g_object_set(element_named(pipeline, "audio_file").get(), "location", track.file.c_str(),
               nullptr);
  g_signal_connect(parser_.get(), "pad-added", G_CALLBACK(link_audio), this);
  constexpr auto kItems =
      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM);
  gst_pad_add_probe(entry_.get(), kItems, on_item, this, nullptr);
  if (decoder_) {
    gst_pad_add_probe(muxer_pad_.get(), GST_PAD_PROBE_TYPE_BUFFER, on_encoded, nullptr, nullptr);
  }
}

bool AudioBranch::takes_error(GstMessage* message) {
  if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_ERROR ||
      !(is_within(GST_MESSAGE_SRC(message), parser_) ||
        is_within(GST_MESSAGE_SRC(message), decoder_))) {
    return false;
  }
  has_failed_ = true;
  // Or the muxer waits for more. On a thread of its own, since the pad may be waiting for pictures
  // from the very thread that tells of the error.
  gst_element_call_async(parser_.get(), end_stream, gst_object_ref(muxer_pad_.get()),
                         gst_object_unref);
  return true;
}

void AudioBranch::end_stream(GstElement* /*parser*/, gpointer pad) {
  gst_pad_send_event(GST_PAD(pad), gst_event_new_eos());
}

void AudioBranch::link_audio(GstElement* /*parser*/, GstPad* pad, gpointer branch) {
  GstPad* entry = static_cast<AudioBranch*>(branch)->entry_.get();
  const GstCapsPtr caps(gst_pad_query_caps(pad, nullptr));
  if (is_audio(caps.get()) && !gst_pad_is_linked(entry)) {
    gst_pad_link(pad, entry);
  }
}

GstPadProbeReturn AudioBranch::on_item(GstPad* /*pad*/, GstPadProbeInfo* info, gpointer branch) {
  auto& self = *static_cast<AudioBranch*>(branch);
  if ((GST_PAD_PROBE_INFO_TYPE(info) & GST_PAD_PROBE_TYPE_BUFFER) != 0) {
    return self.on_buffer(info);
  }
  const bool is_segment = GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) == GST_EVENT_SEGMENT;
  return is_segment ? self.on_segment(info) : GST_PAD_PROBE_OK;
}

/// From here on stamps count from the first picture, so the recording's segment ends here.
GstPadProbeReturn AudioBranch::on_segment(GstPadProbeInfo* info) {
  GstEvent* event = GST_PAD_PROBE_INFO_EVENT(info);
  gst_event_copy_segment(event, &segment_);
  GstSegment plain;
  gst_segment_init(&plain, GST_FORMAT_TIME);
  GST_PAD_PROBE_INFO_DATA(info) = gst_event_new_segment(&plain);
  gst_event_unref(event);
  return GST_PAD_PROBE_OK;
}

GstPadProbeReturn AudioBranch::on_buffer(GstPadProbeInfo* info) {
  GstBuffer* buffer = gst_buffer_make_writable(GST_PAD_PROBE_INFO_BUFFER(info));
  GST_PAD_PROBE_INFO_DATA(info) = buffer;
  const auto time = shifted(GST_BUFFER_PTS(buffer));
  if (!time) {
    return GST_PAD_PROBE_DROP;
  }
  GST_BUFFER_PTS(buffer) = *time;
  GST_BUFFER_DTS(buffer) = *time;
  return GST_PAD_PROBE_OK;
}

/// The AAC encoder puts one packet of silence before the sound (libavcodec's initial_padding is a
/// packet's 1024 samples) and stamps packets as if it did not.
GstPadProbeReturn AudioBranch::on_encoded(GstPad* /*pad*/, GstPadProbeInfo* info,
                                          gpointer /*data*/) {
  GstBuffer* buffer = gst_buffer_make_writable(GST_PAD_PROBE_INFO_BUFFER(info));
  GST_PAD_PROBE_INFO_DATA(info) = buffer;
  const GstClockTime packet = GST_BUFFER_DURATION(buffer);
  if (GST_BUFFER_PTS(buffer) < packet) {
    return GST_PAD_PROBE_DROP;
  }
  GST_BUFFER_PTS(buffer) -= packet;
  GST_BUFFER_DTS(buffer) = GST_BUFFER_PTS(buffer);
  return GST_PAD_PROBE_OK;
}

std::optional<GstClockTime> AudioBranch::shifted(GstClockTime time) const {
  guint64 magnitude = 0;
  const int sign = gst_segment_to_running_time_full(&segment_, GST_FORMAT_TIME, time, &magnitude);
  const SensorDuration running(sign * static_cast<std::int64_t>(magnitude));
  const SensorDuration result = running + offset_;
  if (sign == 0 || result < SensorDuration::zero()) {
    return std::nullopt;
  }
  return static_cast<GstClockTime>(result.count());
}

}  // namespace gimbal
