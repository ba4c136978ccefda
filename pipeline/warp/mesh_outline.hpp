#pragma once

#include <Eigen/Core>
#include <vector>

#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// A piece of the edge of what a mesh shows of its frame, in output pixels.
struct OutlineEdge {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
};

/// All of the edge, walked clockwise. The frame's own cells count, not those drawn around it, and
/// of these the ones that the virtual camera sees.
[[nodiscard]] std::vector<OutlineEdge> outline_of(const WarpMesh& mesh);

}  // namespace gimbal
