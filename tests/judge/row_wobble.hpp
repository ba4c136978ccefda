#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "tests/judge/camera_rotation.hpp"
#include "tests/judge/fast_part.hpp"

namespace gimbal::judge {

/// How the rows of a picture move against each other, which is what a rolling shutter leaves. From
/// one frame to the next the camera's rotation is taken out, and what is left is the median over
/// each of 12 bands of rows, so that neither single tracks' noise nor what moves in the scene
/// counts. Skew that changes, bending and stretching show; a skew that stays, as in a pan at
/// constant rate, does not: nothing moves by it.
class RowWobble {
 public:
  static constexpr std::size_t kBands = 12;

  /// A pair of frames, in order of time.
  void add(double time_s, const Pinhole& camera, const cv::Matx33d& R_to_from,
           const std::vector<Track>& tracks);

  /// Root mean square over bands and frames of the bands' motion above `cutoff_hz`, px a frame.
  [[nodiscard]] double rms_px(double cutoff_hz) const;

 private:
  std::array<std::vector<Measured>, kBands> motion_px_;
};

}  // namespace gimbal::judge
