#pragma once

#include <Eigen/Core>

#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// By its upper left corner.
struct MeshCell {
  int column;
  int row;
};

/// Indices of its vertices.
struct CellCorners {
  int top_left;
  int top_right;
  int bottom_left;
  int bottom_right;
};

[[nodiscard]] CellCorners corners_of(const WarpMesh& mesh, MeshCell cell);

/// Whether the grid has cells outside of the frame: one more all around.
[[nodiscard]] bool has_ring(Border border);

/// Grid lines begin to end - 1.
struct LineRange {
  int begin;
  int end;
};

/// The lines of the frame itself, which are evenly spaced.
struct FrameLines {
  LineRange columns;
  LineRange rows;
};

[[nodiscard]] FrameLines frame_lines(const WarpMesh& mesh);

/// How far the map is from affine across a cell, in output pixels: second differences of the
/// vertices along its rows and its columns, and how much its lower side is longer than its upper.
struct CellBend {
  Eigen::Vector2f along_row;
  Eigen::Vector2f along_column;
  Eigen::Vector2f twist;
};

/// Zero along a side where the frame has only one cell.
[[nodiscard]] CellBend bend_of(const WarpMesh& mesh, MeshCell cell, const FrameLines& frame);

/// Whether the exact map is nearer to the line between a cell's lower left and upper right corners
/// than to that between the other two.
[[nodiscard]] bool rises(const CellBend& bend);

/// The map's second difference along the diagonal that the cell is cut along.
[[nodiscard]] Eigen::Vector2f bend_along_diagonal(const CellBend& bend);

}  // namespace gimbal
