#pragma once

#include <Eigen/Geometry>
#include <cstdint>

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

}  // namespace gimbal
