#pragma once

#include <optional>

#include "pipeline/estimator/error_state.hpp"

namespace gimbal {

/// What a sensor interval adds to the uncertainty, beyond what the error state carries.
struct IntervalNoise {
  Eigen::Matrix3d attitude_rad2 = Eigen::Matrix3d::Zero();  ///< world axes
  double velocity_m2_s2 = 0;                                ///< an axis
};

/// Random walks of what a sensor's errors do, densities.
struct DriftNoise {
  double gyro_bias_rad_s_rts = 0;
  double accel_bias_m_s2_rts = 0;
};

/// The Kalman filter over the error state: the mean is carried sample by sample with the exact
/// exponential, the covariance step by step over what the samples of a step added up to.
/// A value: copy it to save it, assign it to restore it.
class ErrorStateFilter {
 public:
  /// Holds the rate over the interval, so that the turn is exact for a constant one; the same for
  /// the specific force, if there is any. Measured values, with bias and scale.
  void advance(const Eigen::Vector3d& gyro_rad_s, const std::optional<Eigen::Vector3d>& accel_m_s2,
               double interval_s, const IntervalNoise& noise);

  /// Ends a step: brings the covariance to the last sample. Returns the transition.
  ErrorTransition close_step(const DriftNoise& noise);

  /// Uses a measurement of one component of the error, in the order of Kalman's sequential form.
  ScalarUpdate measure(int index, double residual, double noise_variance);

  /// Forgets what the samples since the last step added to the covariance's transition.
  void discard_step() { pending_ = {}; }

  [[nodiscard]] const InertialState& mean() const { return mean_; }
  InertialState& mean() { return mean_; }
  [[nodiscard]] const ErrorCovariance& covariance() const { return P_; }
  ErrorCovariance& covariance() { return P_; }

  /// rad², world axes, at the last sample.
  [[nodiscard]] Eigen::Matrix3d attitude_covariance() const;

  /// Sums over the samples since the last step.
  struct Pending {
    Eigen::Matrix3d rotation_s = Eigen::Matrix3d::Zero();            ///< of R dt
    Eigen::Matrix3d rotation_by_rate_rad = Eigen::Matrix3d::Zero();  ///< of R diag(rate) dt
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();          ///< of R f dt
    Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();              ///< of the measured rate
    double interval_s = 0;
    double accel_interval_s = 0;
    IntervalNoise noise;
  };
  [[nodiscard]] const Pending& pending() const { return pending_; }

 private:
  [[nodiscard]] ErrorTransition transition() const;

  InertialState mean_;
  ErrorCovariance P_ = ErrorCovariance::Zero();
  Pending pending_;
};

}  // namespace gimbal
