#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/intrinsics/board.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// A lens that explains views of a board best, in least squares.
struct LensFit {
  LensParameters lens;
  std::vector<double> sigmas;  ///< of fx, fy, cx, cy and the distortion's coefficients
  std::vector<Eigen::Isometry3d> T_camera_board;           ///< of each view, in squares
  std::vector<std::vector<Eigen::Vector2d>> residuals_px;  ///< of each view: seen less modelled
  double rms_px = 0;                                       ///< of the residuals' lengths
};

/// By OpenCV (Zhang's start, Levenberg and Marquardt), which a single view or a nonsensical set can
/// defeat: nothing then. The standard deviations are those of noise as large as what the fit
/// leaves, alike and independent in all corners. Brown's model gets k1 k2 p1 p2 k3.
[[nodiscard]] std::optional<LensFit> fit_lens(std::span<const BoardView> views, ImageSize size,
                                              LensModel model);

}  // namespace gimbal
