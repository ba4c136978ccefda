#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "pipeline/estimator/estimator.hpp"
#include "pipeline/sample/attitude.hpp"
#include "pipeline/sample/imu_sample.hpp"
#include "pipeline/smoother/fixed_lag_smoother.hpp"

namespace gimbal {

/// Samples in, orientations out, in order of time, at once or some time later.
class AttitudeStream {
 public:
  AttitudeStream() = default;
  AttitudeStream(const AttitudeStream&) = delete;
  AttitudeStream& operator=(const AttitudeStream&) = delete;
  virtual ~AttitudeStream() = default;

  /// Stamps rise strictly.
  virtual void push(const ImuSample& sample) = 0;

  /// No more samples come: what is held is released by `pop`.
  virtual void finish() = 0;

  /// Samples that the estimator skipped have no answer.
  [[nodiscard]] virtual std::optional<AttitudeEstimate> pop() = 0;

  /// One line for a person about samples that cannot be what they claim; empty if nothing is odd.
  [[nodiscard]] virtual std::string_view suspicion() const = 0;

  /// For the next run, see AttitudeEkf. None where nothing was learned that is to be trusted: of an
  /// estimator that has no bias, before the first sample, while something is odd.
  [[nodiscard]] virtual std::optional<GyroBias> gyro_bias() const = 0;
};

/// Each sample's answer at once, from the past alone, by an estimator that says nothing of its
/// error: the covariance is that of an orientation that nobody knows.
[[nodiscard]] std::unique_ptr<AttitudeStream> make_causal_stream(
    std::unique_ptr<Estimator> estimator);

/// The attitude EKF, its answers at once; behind a gate for spikes, as below: a sample that may be
/// one waits for the next.
[[nodiscard]] std::unique_ptr<AttitudeStream> make_causal_stream(
    const AttitudeEkfParameters& parameters);

/// The same for pictures: answers that the filter's corrections reach by and by, see
/// GradualCorrection. Their covariance is the filter's.
[[nodiscard]] std::unique_ptr<AttitudeStream> make_gradual_stream(
    const AttitudeEkfParameters& parameters, SensorDuration memory);

/// The attitude EKF, looking back once the smoother's lag has passed.
[[nodiscard]] std::unique_ptr<AttitudeStream> make_smoothed_stream(
    const FixedLagSmootherParameters& parameters);

}  // namespace gimbal
