#pragma once

#include <Eigen/Core>
#include <array>

#include "pipeline/fill/cell_grid.hpp"
#include "pipeline/fill/cell_look.hpp"
#include "pipeline/fill/seam_shift.hpp"
#include "pipeline/fill/tone_match.hpp"

namespace gimbal {

/// A picture, and how deep each node lies inside of what it shows.
struct ShownPart {
  PicturePlanes planes;
  const NodeField& depth_px;
};

/// How a neighbour's picture goes on from another at its edge.
struct NeighbourFit {
  Tone tone;
  Eigen::Vector2f shift_px;  ///< that it is still to be moved by (`seam_shift_px`)
  /// Luma, U and V that what is lit unevenly still differs by after that.
  std::array<NodeField, 3> difference;
  /// 1 where both show the same at the edge, 0 where something has moved, or is so near that it is
  /// seen from elsewhere; what lies past the edge is as good as the edge beside it.
  NodeField trust;
};

/// Compares them where both show something, up to `reach_px` inside of `there`.
[[nodiscard]] NeighbourFit fit_neighbour(const CellGrid& grid, const ShownPart& there,
                                         const ShownPart& neighbour, float reach_px, float black);

}  // namespace gimbal
