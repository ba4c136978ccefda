#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/gstreamer/conversion_count.hpp"
#include "pipeline/gstreamer/gst_runtime.hpp"
#include "pipeline/sink/audio_branch.hpp"
#include "pipeline/sink/frame_sink.hpp"
#include "pipeline/sink/stream_progress.hpp"

namespace gimbal {

/// A GStreamer pipeline that frames are fed into, and what must be known to speak about it.
struct SinkPipeline {
  /// Has an appsrc of the name kFrameSourceName; not yet started.
  GstPipelinePtr pipeline;
  /// What remains if writing fails, such as "out.mp4 is incomplete and will not play".
  std::string remains;
  std::vector<std::string> warnings;
  std::unique_ptr<AudioBranch> audio;  ///< may be null
  /// How long the pipeline may stand still before that is an error.
  std::chrono::milliseconds patience = std::chrono::seconds(60);
};

inline constexpr const char* kFrameSourceName = "gimbald_frames";

/// Feeds frames into a pipeline without copying them.
class GstreamerSink final : public FrameSink {
 public:
  /// Starts the pipeline. Frames may be larger than `format.size` by a column and a row on the
  /// right and at the bottom, which are left out.
  [[nodiscard]] static Result<std::unique_ptr<FrameSink>> start(SinkPipeline target,
                                                                const SinkFormat& format);

  ~GstreamerSink() override;

  [[nodiscard]] Result<void> write(const VideoFrame& frame) override;
  [[nodiscard]] Result<void> finish() override;
  [[nodiscard]] std::optional<std::int64_t> bytes_copied() const override;
  [[nodiscard]] std::vector<std::string> warnings() const override;

 private:
  /// What becomes of a frame on its way out of the queue, on the pipeline's thread.
  struct FrameGate;

  GstreamerSink(SinkPipeline target, const SinkFormat& format);

  static GstBusSyncReply on_message(GstBus* bus, GstMessage* message, gpointer sink);
  void watch();
  void follow_the_clock(const LiveTiming& live);
  void end_other_sources();
  /// Until the next frame, as far as that can be known: a last frame without it would not be shown.
  [[nodiscard]] SensorDuration shown_for(const VideoFrame& frame) const;
  [[nodiscard]] Result<void> check(const VideoFrame& frame) const;
  [[nodiscard]] Result<void> explain(Result<void> result) const;

  SinkFormat format_;
  std::string remains_;
  std::vector<std::string> warnings_;
  std::unique_ptr<AudioBranch> audio_;
  StreamProgress progress_;
  std::unique_ptr<FrameGate> gate_;
  ConversionCount conversions_;
  std::optional<SensorTime> first_time_;
  SensorTime last_time_;
  GstElementPtr source_;
  GstPipelinePtr pipeline_;  // last, so that its threads end before what they use
};

}  // namespace gimbal
