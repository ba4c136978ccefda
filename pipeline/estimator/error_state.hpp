#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <optional>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

inline constexpr double kGravity_m_s2 = 9.81;  ///< along world -z

/// Where each quantity lies in the error state. Attitude errors are rotation vectors in world axes,
/// q_true = exp(attitude) q; every other error is true less estimated.
struct ErrorIndex {
  enum : int {
    attitude = 0,      ///< rad, world axes
    gyro_bias = 3,     ///< rad/s, IMU axes
    velocity = 6,      ///< m/s, world axes
    accel_bias = 9,    ///< m/s², IMU axes
    gyro_scale = 12,   ///< an axis each: measured = (1 + scale) true + bias
    accel_scale = 15,  ///< common to all axes
    size = 16,
  };
};

using ErrorState = Eigen::Matrix<double, ErrorIndex::size, 1>;
using ErrorCovariance = Eigen::Matrix<double, ErrorIndex::size, ErrorIndex::size>;
using AttitudeRows = Eigen::Matrix<double, 3, ErrorIndex::size>;
/// A column for each component of attitude, then of velocity: what moves from step to step.
using MovingColumns = Eigen::Matrix<double, ErrorIndex::size, 6>;

/// exp: the unit quaternion that turns by the rotation vector (rad).
[[nodiscard]] Eigen::Quaterniond rotation_from_vector(const Eigen::Vector3d& rotation_rad);

/// log: the inverse, up to a half turn.
[[nodiscard]] Eigen::Vector3d vector_from_rotation(const Eigen::Quaterniond& rotation);

/// What the filter believes; the error state is about these.
struct InertialState {
  Eigen::Quaterniond q_world_imu = Eigen::Quaterniond::Identity();
  Eigen::Vector3d gyro_bias_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias_m_s2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_scale = Eigen::Vector3d::Zero();
  double accel_scale = 0;

  void correct(const ErrorState& error);
};

/// How errors go from one step to the next: x' = F x with F the identity but for the rows of
/// attitude and velocity. Velocity couples with attitude through gravity alone. Through the rest of
/// the specific force a wrong heading would show in the velocity too, but a velocity that is merely
/// bounded, not measured, must not turn the heading.
struct ErrorTransition {
  Eigen::Matrix3d attitude_by_gyro_bias = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d attitude_by_gyro_scale = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d velocity_by_attitude = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d velocity_by_gyro_bias = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d velocity_by_gyro_scale = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d velocity_by_accel_bias = Eigen::Matrix3d::Zero();
  Eigen::Vector3d velocity_by_accel_scale = Eigen::Vector3d::Zero();
  /// False where attitude and velocity started anew, so that their old errors say nothing.
  bool is_continuous = true;

  /// Velocity no longer changes.
  void keep_velocity();

  /// P <- F P Fᵀ. P symmetric.
  void propagate(ErrorCovariance& P) const;

  /// Fᵀ - I, by which information about a later error becomes information about an earlier one, but
  /// for the columns that are zero.
  [[nodiscard]] MovingColumns back_from_attitude_and_velocity() const;
};

/// A measurement of one component of the error state, after it was used.
struct ScalarUpdate {
  int index = 0;
  double residual = 0;  ///< measured less expected
  double variance = 1;  ///< of the residual
  ErrorState gain = ErrorState::Zero();
};

/// The world turned under a device whose tilt became known, and with it under all that came before.
struct WorldTurn {
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  /// New attitude error by the error of the gyroscope's bias, s: what it has turned unseen.
  Eigen::Matrix3d attitude_by_gyro_bias = Eigen::Matrix3d::Zero();
  AttitudeRows rows = AttitudeRows::Zero();  ///< what the covariance gained
};

/// One step of the filter, as a smoother needs it.
struct FilterStep {
  static constexpr std::size_t kMaxUpdates = 8;

  SensorTime time;
  ErrorTransition transition;                     ///< from the step before to this one
  std::array<ScalarUpdate, kMaxUpdates> updates;  ///< the first `update_count` in order
  std::size_t update_count = 0;
  Eigen::Vector3d attitude_correction = Eigen::Vector3d::Zero();  ///< by all updates together
  std::optional<WorldTurn> world_turn;                ///< at this step, after its updates
  AttitudeRows attitude_rows = AttitudeRows::Zero();  ///< of the covariance after the updates
};

}  // namespace gimbal
