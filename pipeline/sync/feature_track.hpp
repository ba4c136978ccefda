#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace gimbal {

/// Where a corner was seen in one picture.
struct TrackPoint {
  std::size_t frame = 0;  ///< place in the list of stamps
  Eigen::Vector2d px;     ///< whole coordinates at pixel centres
};

/// One corner of the scene, followed from picture to picture without a break.
using FeatureTrack = std::vector<TrackPoint>;

}  // namespace gimbal
