#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/imu_source.hpp"
#include "drivers/synthetic/motion.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// How a sensor of three axes errs: sample = saturated(scale x truth + bias + noise). Units are the
/// sensor's: rad/s for a gyroscope, m/s² for an accelerometer.
struct TriaxialErrors {
  double noise_density = 0;  ///< white, unit/√Hz, one-sided: a sample has this times √(rate/2)
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< when the motion begins
  double bias_walk = 0;                            ///< unit/√s: the bias' random walk
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  double full_scale = std::numeric_limits<double>::infinity();
};

/// A stretch of true time.
struct TimeSpan {
  SensorTime from;
  SensorTime to;  ///< one past the end
};

/// When a sensor samples: `rate_hz` times a second, first at `phase` after the span's begin.
struct SampleClock {
  double rate_hz = 0;  ///< 0 for a sensor that is not there
  SensorDuration phase{};
};

struct SyntheticImuSettings {
  Eigen::Matrix3d R_camera_imu = Eigen::Matrix3d::Identity();
  TimeSpan span;
  SampleClock gyro_clock;
  SampleClock accel_clock;
  TriaxialErrors gyro;
  TriaxialErrors accel;
  SensorDuration clock_offset{};   ///< added to true time to get stamps
  std::vector<TimeSpan> dropouts;  ///< no samples in these
  std::uint64_t seed = 0;
};

/// A gyroscope and an accelerometer fixed to a moving camera. Each sample is of one instant.
class SyntheticImu : public ImuSource {
 public:
  /// Refuses rates that are negative or above 100 kHz, an R_camera_imu that is no rotation and a
  /// span that ends before it begins.
  [[nodiscard]] static Result<std::unique_ptr<SyntheticImu>> create(
      const SyntheticImuSettings& settings, const Motion& motion);

  Result<void> start() override;
  Result<std::optional<ImuReading>> read() override;
  void stop() override;

  /// All that is read, in order.
  [[nodiscard]] const std::vector<GyroSample>& gyro() const { return gyro_; }
  [[nodiscard]] const std::vector<AccelSample>& accel() const { return accel_; }

  /// The truth: the gyro's bias at each of its samples, in rad/s.
  [[nodiscard]] const std::vector<Eigen::Vector3d>& gyro_bias() const { return gyro_bias_; }

 private:
  SyntheticImu() = default;

  std::vector<GyroSample> gyro_;
  std::vector<AccelSample> accel_;
  std::vector<Eigen::Vector3d> gyro_bias_;
  std::size_t next_gyro_ = 0;
  std::size_t next_accel_ = 0;
  std::atomic<bool> running_ = false;
};

/// What an ideal gyroscope feels, in IMU axes, rad/s.
[[nodiscard]] Eigen::Vector3d true_gyro(const MotionState& state,
                                        const Eigen::Matrix3d& R_camera_imu);

/// What an ideal accelerometer at the camera's centre feels, in IMU axes, m/s²: the camera's
/// acceleration less gravity (thesis 2.13).
[[nodiscard]] Eigen::Vector3d true_specific_force(const MotionState& state,
                                                  const Eigen::Matrix3d& R_camera_imu);

}  // namespace gimbal
