#pragma once

#include "pipeline/fill/cell_grid.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// How many output pixels each node lies inside of the frame as the mesh shows it, to its nearest
/// edge; negative outside. Held between plus and minus `most_px`. Straight edges are straight
/// between the nodes, too.
[[nodiscard]] NodeField frame_depth(const WarpMesh& mesh, const CellGrid& grid, float most_px);

}  // namespace gimbal
