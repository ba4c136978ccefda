#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "pipeline/sync/gyro_integral.hpp"
#include "pipeline/sync/visual_turn.hpp"

namespace gimbal {

/// Which time offsets come into question.
struct OffsetSearch {
  double middle_s = 0;
  double half_width_s = 0.6;
  double step_s = 0.004;
};

/// Rising.
[[nodiscard]] std::vector<double> offsets_of(const OffsetSearch& search);

/// How well the gyroscope explains how the picture turned, at one time offset.
struct AxesFit {
  double offset_s = 0;
  Eigen::Matrix3d M_camera_imu = Eigen::Matrix3d::Identity();  ///< orthogonal; mirrored if det < 0
  double explained = 0;  ///< share of the turns' variance, at most 1
  /// The same for the best matrix of the other handedness: a mirrored one if M is a rotation.
  double explained_other = 0;
};

/// The rotation between IMU and camera and the time offset with which both feel the same angular
/// rates, from nothing known: at each offset by the orthogonal matrix of least squares (Kabsch,
/// Acta Cryst. A32, 1976), mirrored ones included. Constant biases do not matter. Sorted by offset;
/// offsets at which the log covers less than half of the turns are left out.
[[nodiscard]] std::vector<AxesFit> axes_fits(const std::vector<VisualTurn>& turns,
                                             const GyroIntegral& gyro, const OffsetSearch& search);

/// The best of them; nothing if there is none.
[[nodiscard]] std::optional<AxesFit> best_fit(const std::vector<AxesFit>& fits);

}  // namespace gimbal
