#pragma once

#include <Eigen/Core>
#include <vector>

#include "pipeline/fill/tone_match.hpp"

namespace gimbal {

/// Pixels that `given` has to be moved by to lie on `wanted`, from their gradients; good for few
/// pixels, and for more when it is measured again after the move (Lucas and Kanade, "An iterative
/// image registration technique", 1981). Zero where there is too little to tell it by.
[[nodiscard]] Eigen::Vector2f seam_shift_px(const std::vector<CellPair>& pairs, const Tone& tone);

/// What orientations drift apart by from frame to frame: a gyroscope's bias about the vertical is
/// known to nobody, and moves a neighbour by pixels within a second. It hardly changes, so that
/// what was measured along seams tells where the next neighbour lies.
class SeamDrift {
 public:
  /// Where a frame so much later than the one that is drawn (negative: earlier) has to be moved to.
  [[nodiscard]] Eigen::Vector2f expected_px(double later_s) const;

  void learn(double later_s, const Eigen::Vector2f& moved_px);

 private:
  double square_s2_ = 0;
  Eigen::Vector2d product_px_s_ = Eigen::Vector2d::Zero();
};

}  // namespace gimbal
