#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace gimbal::judge {

/// A value of up to three components that was measured at a time.
struct Measured {
  double time_s = 0;
  cv::Vec3d value;
};

/// What changes faster than `cutoff_hz`: the series less its low-passed self, a Hann window of two
/// of the cut-off's periods, weighted anew where the series ends or has gaps. Times rise.
[[nodiscard]] std::vector<cv::Vec3d> fast_part(const std::vector<Measured>& series,
                                               double cutoff_hz);

/// Root mean square of the vectors' lengths; 0 of none.
[[nodiscard]] double rms_length(const std::vector<cv::Vec3d>& vectors);

}  // namespace gimbal::judge
