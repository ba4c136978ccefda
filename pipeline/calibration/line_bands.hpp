#pragma once

#include <Eigen/Core>
#include <complex>
#include <span>
#include <vector>

#include "pipeline/calibration/flashing_light.hpp"

namespace gimbal {

/// What changes from frame to frame in the brightness of lines, and how sines of so many periods in
/// a picture explain it.
class LineBands {
 public:
  /// Precondition: one profile at least.
  explicit LineBands(std::span<const LineProfile> profiles);

  [[nodiscard]] Eigen::Index lines() const { return changes_.rows(); }

  /// Root of the mean square change, as a share of a line's mean brightness.
  [[nodiscard]] double contrast() const;

  /// Share of the changes' variance that one sine a frame explains.
  [[nodiscard]] double explained(double bands) const;

  /// Amplitudes of the given harmonics of these bands in each frame, a column a frame:
  /// light = Re(amplitude exp(i phase)), phase rising along the lines.
  [[nodiscard]] Eigen::MatrixXcd amplitudes(double bands, std::span<const int> harmonics) const;

 private:
  Eigen::MatrixXd changes_;  ///< lines by frames: light over the line's mean, less the frame's mean
};

}  // namespace gimbal
