#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// The edge of a frame in the picture that is drawn: a closed polygon in output pixels.
using PicturePolygon = std::vector<Eigen::Vector2d>;

/// A frame that something may be taken from.
struct NeighbourCandidate {
  PicturePolygon outline_px;
  double apart_s = 0;  ///< from the frame that is drawn, either way
};

/// Few frames that together show most of what the frame with that outline leaves uncovered, the
/// nearest in time first: what is far in time may have moved. Where they can, two show the same,
/// for one of them may turn out not to be trusted. Indices of `candidates`, at most `most`; none
/// where nothing is uncovered.
[[nodiscard]] std::vector<std::size_t> choose_neighbours(
    ImageSize picture, const PicturePolygon& outline_px,
    const std::vector<NeighbourCandidate>& candidates, std::size_t most);

}  // namespace gimbal
