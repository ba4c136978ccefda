#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "daemon/live_pipeline.hpp"
#include "pipeline/sync/corner_follower.hpp"
#include "pipeline/sync/offset_tracker.hpp"

namespace gimbal {

/// Tracks the time offset of a live camera on a thread of its own, of low priority. Takes a burst
/// of frames now and then, so seldom that its share of a core stays below a bound; frames are never
/// held, only a small copy of their luma is made.
class OffsetTracking final : public SourceObserver {
 public:
  using Use = std::function<void(const OffsetReport&)>;

  /// `corners` lives longer. `cpu_share`: of one core, at most; above 0.
  [[nodiscard]] static Result<std::unique_ptr<OffsetTracking>> create(
      const CameraCalibration& camera, const ImuCalibration& imu, const CornerFollower& corners,
      double cpu_share);

  OffsetTracking(const OffsetTracking&) = delete;
  OffsetTracking& operator=(const OffsetTracking&) = delete;
  ~OffsetTracking() override;

  void saw(const VideoFrame& frame) override;
  void saw(const ImuReading& reading) override;

  /// `use` is called on the thread that tracks, several times a second.
  void start(Use use);
  void stop();

 private:
  using Burst = std::vector<SmallPicture>;

  OffsetTracking(OffsetTracker tracker, const CameraCalibration& camera,
                 const CornerFollower& corners, double cpu_share);

  // On the thread that tracks.
  void run();
  [[nodiscard]] std::optional<Burst> wait_for_burst();
  void take_gyro();
  [[nodiscard]] Worth worth_of(const Burst& burst);
  void follow(const Burst& pictures);
  void pace();
  void report();
  void log_changes(const OffsetEstimate& estimate);
  [[nodiscard]] SensorDuration cpu_time() const;

  const CornerFollower& corners_;
  const int block_px_;
  const int stride_frames_;  ///< from one frame of a burst to the next
  const double cpu_share_;

  // On the camera's thread.
  Burst growing_;
  int passed_ = 0;  ///< frames since the last of these

  std::atomic<SensorTime> next_burst_ = SensorTime::min();
  std::atomic<SensorTime> last_frame_ = SensorTime();
  std::atomic<SensorDuration> copy_time_ = SensorDuration::zero();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Burst> burst_;
  std::vector<GyroSample> gyro_;
  bool stops_ = false;

  // On the thread that tracks.
  OffsetTracker tracker_;
  Use use_;
  SensorDuration paced_cpu_time_{};
  std::optional<SensorDuration> last_known_;
  SensorDuration logged_{};
  SensorTime logged_at_;

  std::thread thread_;
};

}  // namespace gimbal
