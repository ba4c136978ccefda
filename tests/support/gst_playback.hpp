#pragma once

#include <gst/app/gstappsink.h>
#include <gst/gst.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace gimbal::test {

struct PlayedBuffer {
  std::int64_t running_time_ns = 0;
  std::vector<std::uint8_t> bytes;
};

struct Playback {
  std::string caps;
  std::vector<PlayedBuffer> buffers;
};

inline PlayedBuffer played_buffer(GstSample* sample) {
  GstBuffer* buffer = gst_sample_get_buffer(sample);
  PlayedBuffer played;
  played.running_time_ns = static_cast<std::int64_t>(gst_segment_to_running_time(
      gst_sample_get_segment(sample), GST_FORMAT_TIME, GST_BUFFER_PTS(buffer)));
  played.bytes.resize(gst_buffer_get_size(buffer));
  gst_buffer_extract(buffer, 0, played.bytes.data(), played.bytes.size());
  return played;
}

inline bool has_failed(GstElement* pipeline) {
  GstBus* bus = gst_element_get_bus(pipeline);
  GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
  gst_object_unref(bus);
  if (message == nullptr) {
    return false;
  }
  gst_message_unref(message);
  return true;
}

/// Null at the end, after an error, or when nothing comes.
inline GstSample* next_sample(GstElement* pipeline, GstElement* out) {
  for (int attempt = 0; attempt < 200; ++attempt) {
    GstSample* sample = gst_app_sink_try_pull_sample(GST_APP_SINK(out), 100 * GST_MSECOND);
    if (sample != nullptr || gst_app_sink_is_eos(GST_APP_SINK(out)) || has_failed(pipeline)) {
      return sample;
    }
  }
  return nullptr;
}

/// Runs a pipeline that ends in "appsink name=out" and collects what arrives: a reader that shares
/// nothing with the code under test.
inline Playback play(const std::string& pipeline_text) {
  gst_init(nullptr, nullptr);
  Playback playback;
  GError* error = nullptr;
  GstElement* pipeline = gst_parse_launch(pipeline_text.c_str(), &error);
  if (error != nullptr) {
    ADD_FAILURE() << error->message;
    g_error_free(error);
    return playback;
  }
  GstElement* out = gst_bin_get_by_name(GST_BIN(pipeline), "out");
  g_object_set(out, "sync", FALSE, nullptr);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  while (GstSample* sample = next_sample(pipeline, out)) {
    const std::unique_ptr<gchar, decltype(&g_free)> caps(
        gst_caps_to_string(gst_sample_get_caps(sample)), g_free);
    playback.caps = caps.get();
    playback.buffers.push_back(played_buffer(sample));
    gst_sample_unref(sample);
  }
  EXPECT_TRUE(gst_app_sink_is_eos(GST_APP_SINK(out))) << pipeline_text;
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(out);
  gst_object_unref(pipeline);
  return playback;
}

/// Times, in seconds, at which sound sets in after at least 0.5 s of silence.
inline std::vector<double> sound_onsets(const std::filesystem::path& path) {
  constexpr int kSampleRate = 48000;
  const auto playback = play("filesrc location=" + path.string() +
                             " ! decodebin ! audioconvert ! audioresample ! "
                             "audio/x-raw,format=F32LE,channels=1,rate=48000 ! appsink name=out");
  std::vector<double> found;
  double last_sound = -1;
  for (const auto& buffer : playback.buffers) {
    std::vector<float> samples(buffer.bytes.size() / sizeof(float));
    std::memcpy(samples.data(), buffer.bytes.data(), samples.size() * sizeof(float));
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double time =
          1e-9 * static_cast<double>(buffer.running_time_ns) + static_cast<double>(i) / kSampleRate;
      if (std::abs(samples[i]) > 0.3F) {
        if (time - last_sound > 0.5) {
          found.push_back(time);
        }
        last_sound = time;
      }
    }
  }
  return found;
}

/// Runs a pipeline to its end, to make a file.
inline void run_pipeline(const std::string& pipeline_text) {
  gst_init(nullptr, nullptr);
  GError* error = nullptr;
  GstElement* pipeline = gst_parse_launch(pipeline_text.c_str(), &error);
  ASSERT_EQ(error, nullptr) << error->message;
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  GstBus* bus = gst_element_get_bus(pipeline);
  GstMessage* message = gst_bus_timed_pop_filtered(
      bus, 60 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  ASSERT_NE(message, nullptr) << pipeline_text;
  EXPECT_EQ(GST_MESSAGE_TYPE(message), GST_MESSAGE_EOS) << pipeline_text;
  gst_message_unref(message);
  gst_object_unref(bus);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}

}  // namespace gimbal::test
