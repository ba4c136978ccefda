#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>

#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {

struct SpikeGateParameters {
  /// A smaller step from sample to sample is none, nor is one within so many times the recent root
  /// mean square of steps: shakes and vibration go on for longer than a sample. A tap on an
  /// accelerometer may not, and counts in the velocity.
  double smallest_gyro_spike_rad_s = 3;
  double smallest_accel_spike_m_s2 = 100;
  double usual_steps = 8;
  double memory_s = 0.5;
  SensorDuration longest_interval = std::chrono::milliseconds(50);  ///< much may happen in longer
};

/// Takes out what a bus or a chip garbles: a sample that steps far away from the one before, with
/// the next one back again. One that steps far is held until the next one tells.
class SpikeGate {
 public:
  /// In order, as many as `count`.
  struct Passed {
    std::array<ImuSample, 2> samples;
    std::size_t count = 0;
  };

  explicit SpikeGate(const SpikeGateParameters& parameters = {});

  /// Without a spike of the gyroscope the sample goes, with one of the accelerometer that value.
  Passed push(const ImuSample& sample);

  /// No more samples come: what is held passes.
  Passed finish();

  [[nodiscard]] std::size_t spikes() const { return spikes_; }

 private:
  /// Steps of a sensor from sample to sample.
  struct Steps {
    double smallest = 0;
    double mean_square = 0;
  };
  [[nodiscard]] bool steps_far(const ImuSample& sample) const;
  [[nodiscard]] bool is_far(const Steps& steps, const Eigen::Vector3d& step) const;
  [[nodiscard]] bool sticks_out(const Steps& steps, const Eigen::Vector3d& before,
                                const Eigen::Vector3d& value, const Eigen::Vector3d& after) const;
  void judge_held(const ImuSample& next, Passed& passed);
  void pass(const ImuSample& sample, Passed& passed);
  void learn(Steps& steps, const Eigen::Vector3d& step, double interval_s) const;

  SpikeGateParameters parameters_;
  Steps gyro_;
  Steps accel_;
  std::optional<ImuSample> last_;  ///< that passed
  std::optional<ImuSample> held_;
  std::size_t spikes_ = 0;
};

}  // namespace gimbal
