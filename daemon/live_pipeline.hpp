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

#include "daemon/frame_drawer.hpp"
#include "daemon/histogram.hpp"
#include "daemon/output.hpp"
#include "daemon/revived_source.hpp"
#include "daemon/sample_rate.hpp"
#include "daemon/stabilization.hpp"
#include "drivers/camera_source.hpp"
#include "drivers/imu_source.hpp"
#include "pipeline/fill/past_frames.hpp"
#include "pipeline/queue/bounded_queue.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/stabilizer.hpp"
#include "pipeline/sync/offset_glide.hpp"
#include "pipeline/sync/offset_tracker.hpp"
#include "pipeline/timing/imu_aligner.hpp"

namespace gimbal {

/// A camera with an IMU, and what is known of them.
struct LiveSources {
  std::unique_ptr<CameraSource> camera;
  std::unique_ptr<ImuSource> imu;
  CameraFormat format;  ///< what the camera delivers once it is started
  CameraCalibration camera_calibration;
  ImuCalibration imu_calibration;
  Accelerometer accelerometer = Accelerometer::present;
  std::optional<GyroBias> remembered_bias;  ///< from the run before
  std::string device;                       ///< what these are, for people
};

/// Every frame that came in is out, dropped or still held.
struct LiveCounts {
  std::uint64_t frames_in = 0;
  std::uint64_t frames_out = 0;
  std::uint64_t dropped_without_orientation = 0;  ///< more waited than there is room for
  std::uint64_t dropped_before_drawing = 0;       ///< drawing was too slow
  std::uint64_t dropped_out_of_order = 0;         ///< not later than one that came before
  std::uint64_t dropped_off_clock = 0;            ///< stamped more than a second ahead of now
  std::uint64_t no_signal_pictures = 0;           ///< shown while no camera delivered
  std::uint64_t samples = 0;
  std::uint64_t samples_off_clock = 0;  ///< stamped more than a second from now, left out
};

/// From the instant that a frame's stamp names to the end of its drawing.
struct FrameAge {
  SensorDuration median{};
  SensorDuration p99{};
};

/// Where the camera looked when the row was read that a frame is drawn around.
struct CameraAttitude {
  SensorTime time;  ///< on the IMU's clock
  Eigen::Quaterniond q_world_camera;
};

/// What tracking the time offset has come to.
struct OffsetReport {
  OffsetEstimate estimate;
  SensorDuration cpu_time{};  ///< that it took, all together
};

/// How things are at an instant.
struct LiveStatus {
  SourceStatus camera;
  SourceStatus imu;
  bool is_coasting = false;  ///< no samples come: the picture is passed through
  LiveCounts counts;
  FrameAge age;                            ///< of the last frames
  std::optional<CameraAttitude> attitude;  ///< of the last frame that was handed on to be drawn
  std::size_t frames_held = 0;             ///< for the orientations and for the path
  std::size_t inflow_depth = 0;            ///< of what the sources deliver
  std::size_t drawings_depth = 0;          ///< of what waits to be drawn
  Histogram::Counts follow_time;           ///< orientation and path, a frame
  Histogram::Counts drawing_time;          ///< a frame
  Histogram::Counts drawn_age;             ///< of a frame when it is drawn
  std::string suspicion;                   ///< see AttitudeStream; empty if none
  double gyro_rate_hz = 0;                 ///< 0 until it is known
  SensorDuration time_offset{};            ///< that frames are drawn with
  std::optional<OffsetReport> tracked_offset;
};

/// Sees what the sources deliver, on their threads: frames may be native. Must not wait.
class SourceObserver {
 public:
  SourceObserver() = default;
  SourceObserver(const SourceObserver&) = delete;
  SourceObserver& operator=(const SourceObserver&) = delete;
  virtual ~SourceObserver() = default;
  virtual void saw(const VideoFrame& frame) = 0;
  virtual void saw(const ImuReading& reading) = 0;
};

/// Runs the stages on threads: one for each source, one for estimate, smoother and path, one that
/// draws, one for each output. Queues lie only between these. Inertial samples are never dropped;
/// of frames the newest win.
///
/// A source that fails is brought back. Without a camera the outputs get a picture that says so;
/// without an IMU the picture glides to what the camera takes, and back.
class LivePipeline {
 public:
  /// `observers` live longer.
  [[nodiscard]] static Result<std::unique_ptr<LivePipeline>> start(
      LiveSources sources, const StabilizationSettings& settings,
      const std::vector<OutputSettings>& outputs, std::vector<SourceObserver*> observers = {});

  LivePipeline(const LivePipeline&) = delete;
  LivePipeline& operator=(const LivePipeline&) = delete;
  ~LivePipeline();

  /// Stops the sources, lets what is held come out, and ends the outputs properly.
  void stop();

  /// From the next frame on: amount, path, latency, zoom with its limits and speed, border and
  /// horizon. The others are what
  /// they were at the start.
  void apply(const StabilizationSettings& settings);

  /// If it is known, frames come to be drawn with this offset by and by.
  void use(const OffsetReport& offset);

  /// Refuses what the devices cannot do.
  [[nodiscard]] Result<void> check(const StabilizationSettings& settings) const;

  /// Whether nothing more can come out: the sources have ended, a stage has failed, or no output is
  /// left.
  [[nodiscard]] bool has_ended() const;

  /// What made it end, if that was a failure.
  [[nodiscard]] std::optional<Error> failure() const;

  /// Grows as long as pictures are drawn, whatever they show.
  [[nodiscard]] std::uint64_t progress() const { return frames_out_ + no_signal_pictures_; }

  [[nodiscard]] LiveStatus status() const;
  [[nodiscard]] LiveCounts counts() const;
  [[nodiscard]] FrameAge age() const;  ///< of the last frames
  [[nodiscard]] const std::vector<std::unique_ptr<Output>>& outputs() const { return outputs_; }
  [[nodiscard]] const CameraCalibration& calibration() const { return calibration_; }
  [[nodiscard]] const ImuCalibration& imu_calibration() const { return imu_calibration_; }

  /// What draws.
  [[nodiscard]] std::string renderer() const;
  /// See Warper::transfers.
  [[nodiscard]] std::string transfers() const;

  /// For the next run; see AttitudeStream.
  [[nodiscard]] std::optional<GyroBias> gyro_bias() const;

 private:
  using Inflow = std::variant<GyroSample, AccelSample, VideoFrame, StabilizationSettings,
                              SourceLost, SourceEnd>;

  LivePipeline(LiveSources sources, Stabilizer stabilizer, const StabilizationSettings& settings,
               const std::vector<OutputSettings>& outputs, std::vector<SourceObserver*> observers);

  [[nodiscard]] Result<void> start_threads();
  [[nodiscard]] std::unique_ptr<CameraPath> new_path() const;

  // Each on a thread of its own.
  void read_camera();
  void read_imu();
  void follow();
  void draw(std::promise<Result<void>>& can_draw);

  // On the thread of `follow`.
  void take(const GyroSample& sample);
  void take(const AccelSample& sample);
  void take(const VideoFrame& frame);
  void take(const StabilizationSettings& settings);
  void take(SourceLost);
  void take(SourceEnd);
  void push_aligned_samples();
  void coast_if_the_imu_is_silent(const FrameStamp& stamp);
  void hand_on_all();
  void hand_on(const VirtualCamera& camera);
  [[nodiscard]] std::vector<Neighbour> neighbours_of(const VirtualCamera& camera) const;
  void let_go_of_first();

  // On the thread of `draw`.
  [[nodiscard]] Result<std::unique_ptr<Warper>> open_warper(DmaBufUse dma_bufs);
  [[nodiscard]] Result<std::unique_ptr<Warper>> open_warper_again(std::unique_ptr<Warper> failed,
                                                                  const Error& error);
  void tell_transfers(const Warper& warper);
  void hand_out(DrawnFrame drawn);
  void draw_no_signal();
  void show(VideoFrame frame);

  void note_age(SensorDuration age);
  void fail(const Error& error);

  RevivedSource<CameraSource, VideoFrame> camera_;
  RevivedSource<ImuSource, ImuReading> imu_;
  const CameraFormat format_;
  const CameraCalibration calibration_;
  const ImuCalibration imu_calibration_;
  const Accelerometer accelerometer_;
  const std::vector<SourceObserver*> observers_;
  std::vector<std::unique_ptr<Output>> outputs_;

  BoundedQueue<Inflow, WhenFull::wait> inflow_;
  FrameDrawer::Waiting drawings_;

  // Used by `follow` alone.
  StabilizationSettings settings_;
  Stabilizer stabilizer_;
  ImuAligner aligner_;
  std::deque<VideoFrame> held_;  ///< for the orientations and for the path
  PastFrames past_;              ///< for border fill
  SampleRate gyro_rate_;
  OffsetGlide glide_;  ///< of what is added to the calibration's time offset
  std::optional<SensorTime> last_frame_;
  std::optional<SensorTime> last_sample_;
  int sources_running_ = 2;

  PictureForm wanted_form_ = PictureForm::nv12;  ///< by the warper, before the camera starts

  // Used by `draw` alone.
  std::optional<VideoFrame> no_signal_;  ///< drawn when it is first wanted
  std::optional<SensorTime> last_shown_;

  std::atomic<std::uint64_t> frames_in_ = 0;
  std::atomic<std::uint64_t> frames_out_ = 0;
  std::atomic<std::uint64_t> dropped_without_orientation_ = 0;
  std::atomic<std::uint64_t> dropped_out_of_order_ = 0;
  std::atomic<std::uint64_t> dropped_off_clock_ = 0;
  std::atomic<std::uint64_t> no_signal_pictures_ = 0;
  std::atomic<std::uint64_t> samples_ = 0;
  std::atomic<std::uint64_t> samples_off_clock_ = 0;
  std::atomic<std::size_t> frames_held_ = 0;
  Histogram follow_time_;
  Histogram drawing_time_;
  Histogram drawn_age_;
  std::atomic<SensorDuration> wanted_correction_ = SensorDuration::zero();
  std::atomic<SensorDuration> correction_ = SensorDuration::zero();
  std::atomic<bool> is_camera_lost_ = false;
  std::atomic<bool> is_coasting_ = false;
  std::atomic<bool> has_ended_ = false;

  mutable std::mutex mutex_;
  std::string renderer_;
  std::string transfers_;
  std::string suspicion_;
  std::optional<CameraAttitude> attitude_;
  std::optional<GyroBias> gyro_bias_;
  std::optional<OffsetReport> tracked_offset_;
  std::optional<Error> failure_;
  std::deque<SensorDuration> ages_;

  std::vector<std::thread> threads_;
};

}  // namespace gimbal
