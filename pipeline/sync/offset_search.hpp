#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "pipeline/sync/gyro_integral.hpp"
#include "pipeline/sync/turn_miss.hpp"

namespace gimbal {

/// How far from where it is expected an offset is looked for.
constexpr double kOffsetReach_s = 0.5;

/// The offset, within kOffsetReach_s of `middle_s`, at which the gyroscope felt the turns that were
/// seen, to within some milliseconds; from sums of distances, which count outliers little. Nothing
/// if there are too few turns whose surroundings the log covers, or if another offset explains them
/// nearly as well.
[[nodiscard]] std::optional<double> find_offset(std::span<const TurnMiss> seen,
                                                const GyroIntegral& gyro,
                                                const Eigen::Matrix3d& R_camera_imu,
                                                double middle_s);

/// The best within some milliseconds of `offset_s`, about which the turns were seen.
[[nodiscard]] double improve_offset(std::span<const TurnMiss> seen, const GyroIntegral& gyro,
                                    const Eigen::Matrix3d& R_camera_imu, double offset_s);

}  // namespace gimbal
