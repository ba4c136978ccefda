#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pipeline/estimator/error_state_filter.hpp"

namespace gimbal {

struct TiltAlignmentParameters {
  double first_force_sigma_rad = 0.5;  ///< of the tilt that one force shows in the middle of a move
  /// Of the velocity, an axis, and how much more it is where the device is shaken: times the
  /// acceleration's root mean square.
  double velocity_sigma_m_s = 0.15;
  double velocity_by_accel_s = 0.1;
  double aligned_sigma_rad = 0.1;  ///< from here on a filter may take errors for small
  double longest_s = 3;
};

/// Which way is up, from the first moments' forces, whatever the device did: integrated in axes
/// that the gyroscope holds still, all that accelerations leave is the change of velocity from
/// beginning to end, the less the longer it goes on. The first force is a guess that keeps the mean
/// of the first tenths from running away. Nothing is linearized, so that it may be as wrong as it
/// likes. A value: copy it to save it.
class TiltAlignment {
 public:
  explicit TiltAlignment(const TiltAlignmentParameters& parameters) : parameters_(parameters) {}

  /// The first force, in the axes that are held still.
  void start(const Eigen::Vector3d& force_m_s2);

  [[nodiscard]] bool has_started() const { return first_direction_ != Eigen::Vector3d::Zero(); }

  /// Sums over the samples of a step, in the axes that are held still, and how fast a machine may
  /// carry the device, an axis, by all that is known then.
  void add(const ErrorStateFilter::Pending& step, double machine_velocity_m_s);

  /// From the axes that are held still to upright ones, by all forces up to now: those added and
  /// those of the step that is not over yet. The identity before any force.
  [[nodiscard]] Eigen::Quaterniond turn_upright(const ErrorStateFilter::Pending& step) const;

  /// Of the tilt by all that was added, rad² about each horizontal axis, without what a bias of the
  /// gyroscope turned meanwhile.
  [[nodiscard]] double tilt_variance_rad2() const;

  /// Of the velocity at the end, an axis.
  [[nodiscard]] double velocity_variance_m2_s2() const;

  /// Of a velocity's component with the tilt error that it caused, m/s rad: the rotation is about
  /// the axis which is that of the velocity turned by 90 degrees.
  [[nodiscard]] double velocity_tilt_covariance() const;

  [[nodiscard]] double accel_mean_square_m2_s4() const;  ///< beside its mean

  /// A bias has turned the axes by this much of itself, on average over the forces.
  [[nodiscard]] Eigen::Matrix3d turn_by_gyro_bias_s() const { return 0.5 * rotation_s_; }

  /// Longer would not help, given how well an axis of the gyroscope's bias is known.
  [[nodiscard]] bool is_done(double gyro_bias_variance_rad2_s2) const;

 private:
  [[nodiscard]] double mean_variance_rad2(double interval_s) const;

  TiltAlignmentParameters parameters_;
  Eigen::Vector3d first_direction_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_m_s_ = Eigen::Vector3d::Zero();
  double force_square_m2_s3_ = 0;
  Eigen::Matrix3d rotation_s_ = Eigen::Matrix3d::Zero();
  double interval_s_ = 0;
  double machine_velocity_m_s_ = 0;
};

}  // namespace gimbal
