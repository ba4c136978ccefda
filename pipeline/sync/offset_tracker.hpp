#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/imu_sample.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sync/feature_track.hpp"
#include "pipeline/sync/gyro_integral.hpp"
#include "pipeline/sync/offset_filter.hpp"
#include "pipeline/sync/sighting.hpp"
#include "pipeline/sync/turn_miss.hpp"

namespace gimbal {

/// Some pictures that came one after the other, and the corners that were followed through them.
struct FollowedBurst {
  std::vector<FrameStamp> frames;
  std::vector<FeatureTrack> corners;
};

/// What is known of the time offset at an instant.
struct OffsetEstimate {
  SensorDuration offset{};  ///< added to stamps to get the IMU's clock
  SensorDuration sigma{};
  double drift = 0;  ///< seconds a second
  bool is_known =
      false;  ///< otherwise it cannot be told, and the offset is the last that was known
};

/// Whether a burst of frames would tell anything of the offset.
enum class Worth : std::uint8_t {
  nothing,
  something,
  unknown,  ///< the gyroscope's samples have not come as far
};

/// Follows the time offset of a camera that runs on, from a burst of pictures now and then. Looks
/// for it within half a second of the calibration's, then filters what turns that are seen differ
/// by from those that are felt; when these begin to disagree it looks for it anew. While nothing
/// turns it keeps what it knows, ever less surely.
///
/// Owns no thread and reads no clock. Takes lens, axes, readout time and reference instant as they
/// are calibrated.
class OffsetTracker {
 public:
  [[nodiscard]] static Result<OffsetTracker> create(const CameraCalibration& camera,
                                                    const ImuCalibration& imu);

  /// Samples whose stamps do not rise are left out.
  void push(const GyroSample& sample);

  /// Of a burst from one frame to another: nothing where the camera hardly turns.
  [[nodiscard]] Worth worth_of(const FrameStamp& from, const FrameStamp& to) const;

  /// In order of time. Those whose surroundings the gyroscope's log does not cover are left out.
  void push(const FollowedBurst& burst);

  [[nodiscard]] OffsetEstimate estimate_at(SensorTime time) const;

 private:
  struct Seen {
    double time_s = 0;  ///< the second picture's stamp
    std::vector<SightingPair> corners;
  };

  OffsetTracker(const CameraCalibration& camera, const ImuCalibration& imu, SightingMaker maker);

  [[nodiscard]] std::optional<GyroIntegral> gyro_between(double from_s, double to_s,
                                                         const Eigen::Vector3d& bias_rad_s) const;
  [[nodiscard]] std::optional<TurnMiss> miss_of(const Seen& seen, const OffsetFilter& filter) const;
  void push(Seen seen);
  void follow(const Seen& seen);
  void lose();
  void look_for_offset();
  [[nodiscard]] std::vector<TurnMiss> turns_seen(const OffsetFilter& filter) const;
  [[nodiscard]] bool learns_from_recent(OffsetFilter& filter) const;

  double readout_s_;
  Eigen::Matrix3d R_camera_imu_;
  SightingMaker maker_;
  std::deque<GyroSample> gyro_;
  OffsetFilter filter_;
  std::optional<double> time_s_;  ///< of the filter; none before it was first right
  bool is_found_ = false;
  int disagreeing_ = 0;      ///< pairs, less those that agreed
  std::deque<Seen> recent_;  ///< pairs that an offset is looked for with
};

}  // namespace gimbal
