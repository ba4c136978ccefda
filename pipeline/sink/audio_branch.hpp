#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "pipeline/gstreamer/gst_runtime.hpp"
#include "pipeline/sink/frame_sink.hpp"

namespace gimbal {

/// How a recording's audio gets into a file.
struct AudioPlan {
  /// Pipeline text that ends at the muxer's audio pad; empty if there is no audio to carry.
  std::string text;
  /// Why the audio is not carried, or not unchanged; empty if neither.
  std::string warning;
};

/// Whether there is any audio in the recording; false if that cannot be told.
[[nodiscard]] bool has_audio(const AudioTrack& track);

/// Looks at the recording's first audio stream. It goes in as it is coded if the muxer (by the name
/// `muxer` in the text, an element of type `muxer_element`) takes it, and re-encoded as AAC if not.
[[nodiscard]] AudioPlan plan_audio(const AudioTrack& track, const char* muxer_element);

/// The running part of a plan: shifts the audio onto the pictures' times and leaves out what would
/// come before the first picture. Must outlive the pipeline.
class AudioBranch {
 public:
  /// `pipeline` was built with the plan's text and is not yet started.
  AudioBranch(const GstPipelinePtr& pipeline, const AudioTrack& track);
  AudioBranch(const AudioBranch&) = delete;
  AudioBranch& operator=(const AudioBranch&) = delete;
  ~AudioBranch() = default;

  /// Whether the message tells of an error in reading or decoding the audio. The audio ends there
  /// and the pictures go on.
  [[nodiscard]] bool takes_error(GstMessage* message);

  /// Whether `takes_error` took one.
  [[nodiscard]] bool has_failed() const { return has_failed_; }

 private:
  static void end_stream(GstElement* parser, gpointer pad);
  static void link_audio(GstElement* parser, GstPad* pad, gpointer branch);
  static GstPadProbeReturn on_item(GstPad* pad, GstPadProbeInfo* info, gpointer branch);
  GstPadProbeReturn on_segment(GstPadProbeInfo* info);
  GstPadProbeReturn on_buffer(GstPadProbeInfo* info);
  static GstPadProbeReturn on_encoded(GstPad* pad, GstPadProbeInfo* info, gpointer data);
  [[nodiscard]] std::optional<GstClockTime> shifted(GstClockTime time) const;

  SensorDuration offset_;
  GstSegment segment_{};  ///< of the recording; only the audio's thread uses it
  std::atomic<bool> has_failed_ = false;
  GstElementPtr parser_;
  GstElementPtr decoder_;  ///< null if the audio goes unchanged
  GstPadPtr entry_;
  GstPadPtr muxer_pad_;
};

}  // namespace gimbal
