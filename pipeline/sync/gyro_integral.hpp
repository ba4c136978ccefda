#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/sample/imu_sample.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// How the IMU is turned at an instant, as the gyroscope alone knows it.
struct GyroState {
  Eigen::Quaterniond q_start_imu;  ///< from IMU axes now to those at the first sample
  Eigen::Vector3d rate_rad_s;      ///< IMU axes, less the bias
  /// How the orientation depends on the bias, to first order: with a bias greater by d it is
  /// exp(-bias_lever_s d) q_start_imu.
  Eigen::Matrix3d bias_lever_s;
};

/// A gyroscope's log integrated once, to be asked for any instant afterwards. Between samples the
/// rate is a cubic (Catmull-Rom), so that vibration well below half the sampling rate is kept.
class GyroIntegral {
 public:
  /// Preconditions: stamps rise, two samples at least. Times asked for count from `zero`.
  GyroIntegral(std::span<const GyroSample> samples, SensorTime zero,
               const Eigen::Vector3d& bias_rad_s);

  /// Nothing outside the log.
  [[nodiscard]] std::optional<GyroState> at(double time_s) const;

  /// Whether the log covers this stretch without a gap.
  [[nodiscard]] bool covers(double from_s, double to_s) const;

 private:
  /// The rate as a + b u + c u² + d u³, u = 0..1 from one sample to the next.
  struct Segment {
    double begin_s = 0;
    double length_s = 0;
    Eigen::Matrix<double, 3, 4> rate_rad_s;
    Eigen::Quaterniond q_start_imu;  ///< at its begin
    Eigen::Matrix3d bias_lever_s;    ///< at its begin
    std::size_t gaps_before = 0;

    [[nodiscard]] Eigen::Vector3d rate(double u) const;
    [[nodiscard]] Eigen::Quaterniond turned(double u) const;
  };

  void fit_rates(std::span<const GyroSample> samples, const Eigen::Vector3d& bias_rad_s);
  void integrate();
  void count_gaps();
  [[nodiscard]] const Segment* segment_at(double time_s) const;

  std::vector<Segment> segments_;
};

}  // namespace gimbal
