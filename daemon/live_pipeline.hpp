#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "daemon/output.hpp"
#include "daemon/stabilization.hpp"
#include "drivers/camera_source.hpp"
#include "drivers/imu_source.hpp"
#include "pipeline/queue/bounded_queue.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/stabilizer.hpp"
#include "pipeline/timing/imu_aligner.hpp"

namespace gimbal {

/// A camera with an IMU, and what is known of them.
struct LiveSources {
  std::unique_ptr<CameraSource> camera;
  std::unique_ptr<ImuSource> imu;
  CameraCalibration camera_calibration;
  ImuCalibration imu_calibration;
  Accelerometer accelerometer = Accelerometer::present;
};

/// Every frame that came in is out, dropped or still held.
struct LiveCounts {
  std::uint64_t frames_in = 0;
  std::uint64_t frames_out = 0;
  std::uint64_t dropped_without_orientation = 0;  ///< the IMU was behind for too long
  std::uint64_t dropped_before_drawing = 0;       ///< drawing was too slow
  std::uint64_t samples = 0;
};

/// From the instant that a frame's stamp names to the end of its drawing.
struct FrameAge {
  SensorDuration median{};
  SensorDuration p99{};
};

/// Runs the stages on threads: one for each source, one for estimate, smoother and path, one that
/// draws, one for each output. Queues lie only between these. Inertial samples are never dropped;
/// of frames the newest win.
class LivePipeline {
 public:
  [[nodiscard]] static Result<std::unique_ptr<LivePipeline>> start(
      LiveSources sources, const StabilizationSettings& settings,
      const std::vector<std::string>& outputs);

  LivePipeline(const LivePipeline&) = delete;
  LivePipeline& operator=(const LivePipeline&) = delete;
  ~LivePipeline();

  /// Stops the sources, lets what is held come out, and ends the outputs properly.
  void stop();

  /// Whether nothing more can come out: the sources have ended, a stage has failed, or no output is
  /// left.
  [[nodiscard]] bool has_ended() const;

  /// What made it end, if that was a failure.
  [[nodiscard]] std::optional<Error> failure() const;

  [[nodiscard]] LiveCounts counts() const;
  [[nodiscard]] FrameAge age() const;  ///< of the last frames
  [[nodiscard]] const std::vector<std::unique_ptr<Output>>& outputs() const { return outputs_; }

  /// What draws.
  [[nodiscard]] const std::string& renderer() const { return renderer_; }

 private:
  struct SourceEnd {};
  using Inflow = std::variant<GyroSample, AccelSample, VideoFrame, SourceEnd>;
  struct Drawing {
    VideoFrame frame;
    WarpMesh mesh;
  };

  LivePipeline(LiveSources sources, Stabilizer stabilizer, const StabilizationSettings& settings,
               const std::vector<std::string>& outputs);

  [[nodiscard]] Result<void> start_threads();

  // Each on a thread of its own.
  void read_camera();
  void read_imu();
  void follow();
  void draw(std::promise<Result<void>>& can_draw);

  void take(const Inflow& item);
  void take_frame(const VideoFrame& frame);
  void push_aligned_samples();
  void hand_on(const VirtualCamera& camera);
  void note_age(SensorTime stamp);
  void fail(const Error& error);

  LiveSources sources_;
  StabilizationSettings settings_;
  std::size_t most_held_;
  std::vector<std::unique_ptr<Output>> outputs_;

  BoundedQueue<Inflow, WhenFull::wait> inflow_;
  BoundedQueue<Drawing, WhenFull::drop_oldest> drawings_;

  // Used by `follow` alone.
  Stabilizer stabilizer_;
  ImuAligner aligner_;
  std::deque<VideoFrame> held_;  ///< for the orientations and for the path
  int sources_running_ = 2;

  std::atomic<std::uint64_t> frames_in_ = 0;
  std::atomic<std::uint64_t> frames_out_ = 0;
  std::atomic<std::uint64_t> dropped_without_orientation_ = 0;
  std::atomic<std::uint64_t> samples_ = 0;
  std::atomic<bool> has_ended_ = false;

  std::string renderer_;
  mutable std::mutex mutex_;
  std::optional<Error> failure_;
  std::deque<SensorDuration> ages_;

  std::vector<std::thread> threads_;
};

}  // namespace gimbal
