#pragma once

#include <Eigen/Core>

namespace gimbal {

/// How far a view may turn away from the real camera before a corner of the picture leaves the
/// frame, to first order: for a turn `d` (rotation vector, rad, in the real camera's axes) and a
/// zoom z the picture stays inside while
///
///   shift_per_rad * d <= side - corner / z
///
/// in each row. Two rows a corner, one for each of the frame's sides that meet there. Lengths are
/// in half pictures. Which view fits exactly is known by `required_zoom`.
struct ViewRoom {
  static constexpr int kLimits = 8;
  using Limits = Eigen::Matrix<double, kLimits, 1>;

  Eigen::Matrix<double, kLimits, 3> shift_per_rad = Eigen::Matrix<double, kLimits, 3>::Zero();
  Limits side = Limits::Ones();    ///< where the frame's side lies
  Limits corner = Limits::Ones();  ///< where the picture's corner lies at zoom 1

  [[nodiscard]] Limits at_zoom(double zoom) const { return side - corner / zoom; }
};

}  // namespace gimbal
