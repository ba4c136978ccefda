#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <numbers>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// Orientation of the IMU at an instant: v_world = q_world_imu v_imu q_world_imu⁻¹, world z up.
/// Hamilton quaternion, unit length.
struct Attitude {
  SensorTime time;
  Eigen::Quaterniond q_world_imu;
};

/// How an answer about an instant was obtained.
enum class AttitudeOrigin : std::uint8_t {
  exact,         ///< an estimate for this very instant
  interpolated,  ///< between two estimates
  predicted,     ///< before the first or after the last estimate, or inside a gap
};

/// An orientation with its uncertainty.
struct AttitudeEstimate {
  Attitude attitude;
  /// Of the error as a rotation vector in world axes, q_true = exp(error) q. Heading counts from
  /// the first sample's, which is the world's by definition.
  Eigen::Matrix3d covariance_rad2 = Eigen::Matrix3d::Zero();
  AttitudeOrigin origin = AttitudeOrigin::exact;
};

/// Nothing at all is known of an angle that is spread evenly over a full turn.
inline constexpr double kUnknownAngle_rad2 = std::numbers::pi * std::numbers::pi / 3;

}  // namespace gimbal
