#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <span>

#include "pipeline/sync/gyro_integral.hpp"
#include "pipeline/sync/sighting.hpp"

namespace gimbal {

/// How the gyroscope is taken to feel the camera's turning.
struct FeltTurning {
  const GyroIntegral& gyro;  ///< its bias taken off
  const Eigen::Matrix3d& R_camera_imu;
  double readout_s = 0;
  double offset_s = 0;  ///< added to stamps to get the gyroscope's clock
};

/// What the turn that two pictures show has beyond the turn that the gyroscope felt between them.
struct TurnMiss {
  Eigen::Vector3d miss_rad;         ///< rotation vector, camera axes at the second picture
  Eigen::Matrix3d covariance_rad2;  ///< as the corners scatter
  Eigen::Vector3d by_offset_rad_s;  ///< how the miss grows with what the offset lacks
  Eigen::Matrix3d by_bias_s;        ///< ... and with what the gyroscope's bias lacks
  double from_s = 0;                ///< the corners' middle instants, before the offset
  double to_s = 0;
  Eigen::Quaterniond q_to_from;  ///< as seen, between camera axes at these instants
};

/// Each corner is turned by what was felt between the instants of its own two rows (thesis 2.37);
/// the miss is the turn that most corners still need, by least squares that count outliers little.
/// Nothing where the log does not reach, or where fewer than ten corners or half of them agree.
[[nodiscard]] std::optional<TurnMiss> turn_miss(std::span<const SightingPair> corners,
                                                const FeltTurning& felt);

}  // namespace gimbal
