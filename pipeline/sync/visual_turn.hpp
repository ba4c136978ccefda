#pragma once

#include <Eigen/Core>
#include <vector>

#include "pipeline/sync/sighting.hpp"

namespace gimbal {

/// How the picture says that the camera turned from one frame to another.
struct VisualTurn {
  double from_s = 0;  ///< the middle line of either frame, before the time offset
  double to_s = 0;
  Eigen::Vector3d rate_rad_s;  ///< mean angular rate, camera axes
};

/// The turn that most corners agree on, for each pair of frames with enough of them; as if nothing
/// were near and all lines of a frame were exposed at once. `pairs` are sorted by their first frame
/// and one stride apart. `readout_s`: what reading a frame takes, roughly.
[[nodiscard]] std::vector<VisualTurn> visual_turns(const std::vector<SightingPair>& pairs,
                                                   double readout_s);

}  // namespace gimbal
