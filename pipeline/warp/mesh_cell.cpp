#include "pipeline/warp/mesh_cell.hpp"

#include <algorithm>
#include <cstddef>

namespace gimbal {
namespace {

/// The second difference of output positions at a line, or at the nearest that has one on either
/// side. `at(line)` is a vertex' position; zero where there are too few lines.
template <typename At>
Eigen::Vector2f bend_at(int line, LineRange lines, const At& at) {
  if (lines.end - lines.begin < 3) return Eigen::Vector2f::Zero();
  const int middle = std::clamp(line, lines.begin + 1, lines.end - 2);
  return at(middle - 1) - 2 * at(middle) + at(middle + 1);
}

}  // namespace

CellCorners corners_of(const WarpMesh& mesh, MeshCell cell) {
  const int top_left = cell.row * mesh.vertex_columns + cell.column;
  const int bottom_left = top_left + mesh.vertex_columns;
  return {top_left, top_left + 1, bottom_left, bottom_left + 1};
}

bool has_ring(Border border) {
  return border == Border::extend || border == Border::mirror;
}

FrameLines frame_lines(const WarpMesh& mesh) {
  const int ring = has_ring(mesh.border) ? 1 : 0;
  return {{ring, mesh.vertex_columns - ring}, {ring, mesh.vertex_rows - ring}};
}

CellBend bend_of(const WarpMesh& mesh, MeshCell cell, const FrameLines& frame) {
  const auto at = [&](int column, int row) -> Eigen::Vector2f {
    const auto index = std::ptrdiff_t{row} * mesh.vertex_columns + column;
    return mesh.vertices[static_cast<std::size_t>(index)].output_px;
  };
  const int column = cell.column;
  const int row = cell.row;
  return {bend_at(column, frame.columns, [&](int line) { return at(line, row); }),
          bend_at(row, frame.rows, [&](int line) { return at(column, line); }),
          at(column + 1, row + 1) - at(column, row + 1) - at(column + 1, row) + at(column, row)};
}

/// Half-way along a diagonal a linear piece is off by an eighth of the map's second difference
/// along it: the bends along both sides, and twice the twist with the sign of the diagonal's slope.
bool rises(const CellBend& bend) {
  // Thousandths of a pixel do not count, nor neighbours that are not visible.
  constexpr float kLeast_px2 = 1e-4F;
  return !((bend.along_row + bend.along_column).dot(bend.twist) < -kLeast_px2);
}

Eigen::Vector2f bend_along_diagonal(const CellBend& bend) {
  const float sign = rises(bend) ? -1.0F : 1.0F;
  return bend.along_row + bend.along_column + 2 * sign * bend.twist;
}

}  // namespace gimbal
