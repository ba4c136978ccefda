#pragma once

#include <cstddef>
#include <deque>
#include <optional>

#include "pipeline/sample/attitude.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

struct AttitudeAnswer {
  Eigen::Quaterniond q_world_imu = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d covariance_rad2 = Eigen::Matrix3d::Zero();  ///< as AttitudeEstimate has it
  AttitudeOrigin origin = AttitudeOrigin::predicted;
};

/// Orientations in order of time, asked for at any instant.
class AttitudeHistory {
 public:
  /// Neighbours further apart than `max_gap` are not trusted: an answer between them says
  /// `predicted`.
  explicit AttitudeHistory(SensorDuration max_gap);

  /// Appends; an estimate that is not later than the last one is refused (false).
  bool append(const AttitudeEstimate& estimate);

  /// Spherical interpolation (SLERP, thesis 4.3) between the neighbours; the nearest end's
  /// orientation outside. An estimate's own instant has its own origin. Precondition: not empty.
  ///
  /// The covariance is the neighbours', and what the device may have done away from them, with its
  /// rate as a random walk as fast as it has lately been: no more is known of it between samples.
  [[nodiscard]] AttitudeAnswer at(SensorTime time) const;

  /// Answers from `time` on stay as they are.
  void forget_before(SensorTime time);

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  /// Precondition of both: not empty.
  [[nodiscard]] const AttitudeEstimate& oldest() const { return entries_.front().estimate; }
  [[nodiscard]] const AttitudeEstimate& newest() const { return entries_.back().estimate; }

 private:
  struct Entry {
    AttitudeEstimate estimate;
    Eigen::Vector3d rate_rad_s = Eigen::Vector3d::Zero();  ///< world axes, since the entry before
    double interval_s = 0;
    std::optional<double> rate_walk_rad2_s3 =
        std::nullopt;  ///< density of the rate's random walk, an axis
  };
  [[nodiscard]] static Entry follow(const Entry& last, const AttitudeEstimate& estimate);
  /// Away from an end, where the device moved like that.
  [[nodiscard]] static AttitudeAnswer held(const Entry& end, const Entry& motion, SensorTime time);

  SensorDuration max_gap_;
  std::deque<Entry> entries_;
};

}  // namespace gimbal
