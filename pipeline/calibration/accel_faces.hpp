#pragma once

#include <Eigen/Core>
#include <span>
#include <string>

#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {

/// How an accelerometer errs: measured = scale true + bias, an axis each.
struct AccelErrors {
  /// Why it is not to be trusted, in one line; empty if it is.
  std::string reason;
  std::size_t poses = 0;  ///< in which the device lay still
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  Eigen::Vector3d bias_m_s2 = Eigen::Vector3d::Zero();
  double residual_m_s2 = 0;  ///< rms of the poses' lengths against gravity's
};

/// From a recording in which the device is laid on each of its six faces for a second or more, by
/// the scales and biases with which every pose has the length of gravity. The faces need not be
/// level; the gyroscope tells when it lies still.
[[nodiscard]] AccelErrors fit_accel_errors(std::span<const AccelSample> accel,
                                           std::span<const GyroSample> gyro);

}  // namespace gimbal
