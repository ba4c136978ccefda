#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/sync/joint_fit.hpp"
#include "pipeline/sync/offset_curve.hpp"

namespace gimbal {

/// What a recording says of the clocks and axes of its camera and its IMU.
struct Synchronization {
  /// Why the result is not to be trusted, in one line; empty if it is.
  std::string reason;
  /// Nothing if the gyroscope does not explain the picture at all.
  std::optional<JointFit> fit;
  /// In words, what is wrong with the gyroscope's axes as they were said to be; empty if nothing.
  std::string axes_fault;
  /// Then no rotation takes the gyroscope's axes to the camera's; the fit is for all three
  /// reversed.
  bool is_left_handed = false;
  std::vector<OffsetCost> curve;
};

/// Finds everything that JointParameters has from nothing but the tracks, the stamps and the gyro:
/// the offset within 0.6 s of the calibration's, axes of any order and sign, the focal length from
/// within 10 %. `R_camera_imu_said` is only what the found axes are compared with in words.
///
/// Says that it cannot tell where the data does not suffice or contradicts itself: too few frames,
/// no texture, no turning, a gyroscope that felt something else, more than one offset that fits, an
/// uncertainty (one sigma) above 1 ms or half a degree.
[[nodiscard]] Synchronization synchronize(const JointData& data,
                                          const Eigen::Matrix3d& R_camera_imu_said);

}  // namespace gimbal
