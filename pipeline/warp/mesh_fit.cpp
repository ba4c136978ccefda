#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "pipeline/warp/mesh_cell.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {
namespace {

/// What to add to a cell's corners. The map runs ahead of the pieces by nothing at the corners, and
/// by -1/8 of its second difference half-way along each side and along the diagonal: the middle of
/// these is what halves the largest.
Eigen::Vector2f move_of(const CellBend& bend) {
  const Eigen::Array2f diagonal = bend_along_diagonal(bend);
  const Eigen::Array2f least = diagonal.min(bend.along_row.array()).min(bend.along_column.array());
  const Eigen::Array2f most = diagonal.max(bend.along_row.array()).max(bend.along_column.array());
  return -(least.min(0.0F) + most.max(0.0F)) / 16;
}

struct Moves {
  Eigen::Vector2f sum = Eigen::Vector2f::Zero();
  int cells = 0;
};

}  // namespace

WarpMesh with_shared_error(WarpMesh mesh) {
  const FrameLines frame = frame_lines(mesh);
  std::vector<Moves> moves(mesh.vertices.size());
  for (int row = frame.rows.begin; row < frame.rows.end - 1; ++row) {
    for (int column = frame.columns.begin; column < frame.columns.end - 1; ++column) {
      const MeshCell cell{column, row};
      const Eigen::Vector2f move = move_of(bend_of(mesh, cell, frame));
      if (!move.allFinite()) continue;  // next to what the virtual camera cannot see
      const auto [top_left, top_right, bottom_left, bottom_right] = corners_of(mesh, cell);
      for (const int corner : {top_left, top_right, bottom_left, bottom_right}) {
        Moves& at_corner = moves[static_cast<std::size_t>(corner)];
        at_corner.sum += move;
        ++at_corner.cells;
      }
    }
  }
  for (std::size_t i = 0; i < moves.size(); ++i) {
    if (moves[i].cells > 0) {
      mesh.vertices[i].output_px += moves[i].sum / static_cast<float>(moves[i].cells);
    }
  }
  return mesh;
}

}  // namespace gimbal
