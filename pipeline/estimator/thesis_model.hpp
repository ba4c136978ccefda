#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "pipeline/sample/imu_sample.hpp"
#include "pipeline/sample/sensor_time.hpp"

// The models of motion and of the accelerometer of G. Hanning, "Video Stabilization and Rolling
// Shutter Correction using Inertial Measurement Sensors", LiTH-ISY-EX--11/4464--SE, 2011, section
// 2.2. Equation numbers are the thesis'. A quaternion here is a plain state vector (q0, q1, q2,
// q3), scalar first, that takes IMU to world axes (z up).

namespace gimbal {

using QuaternionVector = Eigen::Vector4d;

/// How (2.8) is carried over from continuous to discrete time.
enum class Discretization : std::uint8_t {
  exact,        ///< (2.11): exact where the rate is constant over the interval
  small_angle,  ///< (2.12): first order
};

/// S1(ω) of (2.8), q̇ = ½ S1(ω) q: 4x4, antisymmetric. Rate in IMU axes, rad/s.
[[nodiscard]] Eigen::Matrix4d rate_matrix(const Eigen::Vector3d& rate_rad_s);

/// S2(q) of (2.9), q̇ = ½ S2(q) ω: 4x3.
[[nodiscard]] Eigen::Matrix<double, 4, 3> quaternion_matrix(const QuaternionVector& q);

/// q_t = F q_{t-1} + G v_{t-1}, v the error of the measured rate in rad/s.
struct TimeStep {
  Eigen::Matrix4d F;
  Eigen::Matrix<double, 4, 3> G;
};

/// F and G of (2.11) or (2.12) for a rate held over `interval`, at the quaternion before it.
[[nodiscard]] TimeStep discretize(Discretization discretization, const Eigen::Vector3d& rate_rad_s,
                                  SensorDuration interval, const QuaternionVector& q);

/// h(q), (2.13) without acceleration of the device: specific force in IMU axes at rest, m/s².
[[nodiscard]] Eigen::Vector3d accel_at_rest(const QuaternionVector& q);

/// H = dh/dq, (2.16): 3x4.
[[nodiscard]] Eigen::Matrix<double, 3, 4> accel_jacobian(const QuaternionVector& q);

}  // namespace gimbal
