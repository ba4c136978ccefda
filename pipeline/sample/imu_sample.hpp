#pragma once

#include <Eigen/Core>
#include <optional>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// Angular rate in the IMU's axes, right-handed.
struct GyroSample {
  SensorTime time;
  Eigen::Vector3d gyro_rad_s;
};

/// What data sheets mean by g (third CGPM, 1901).
inline constexpr double kStandardGravity_m_s2 = 9.80665;

/// Specific force in the IMU's axes: at rest +9.81 m/s² upward.
struct AccelSample {
  SensorTime time;
  Eigen::Vector3d accel_m_s2;
};

/// One gyro sample with the specific force at the same instant, if there is any.
struct ImuSample {
  SensorTime time;
  Eigen::Vector3d gyro_rad_s;
  std::optional<Eigen::Vector3d> accel_m_s2;
};

}  // namespace gimbal
