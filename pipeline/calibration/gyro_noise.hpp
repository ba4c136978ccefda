#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "pipeline/calibration/allan_deviation.hpp"
#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {

/// What a gyroscope shows while it lies still, an axis each.
struct GyroNoise {
  /// Why it is not to be trusted, in one line; empty if it is.
  std::string reason;
  double still_s = 0;     ///< the longest stretch without a move: all below is of it
  double interval_s = 0;  ///< from sample to sample
  Eigen::Vector3d bias_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d bias_sigma_rad_s = Eigen::Vector3d::Zero();
  /// White noise (angle random walk N): the mean over T has the variance N²/T.
  Eigen::Vector3d noise_rad_s_rthz = Eigen::Vector3d::Zero();
  /// Bias instability: the lowest deviation over 0.664. A minute only bounds it.
  Eigen::Vector3d instability_rad_s = Eigen::Vector3d::Zero();
  /// Random walk of the bias K, rad/s a root of a second: at most so much.
  Eigen::Vector3d most_bias_walk = Eigen::Vector3d::Zero();
  std::array<std::vector<AllanPoint>, 3> allan;
};

/// From the longest still stretch, which must last 30 s.
[[nodiscard]] GyroNoise measure_gyro_noise(std::span<const GyroSample> samples);

}  // namespace gimbal
