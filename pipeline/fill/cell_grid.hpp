#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// A cell by its place in the grid.
struct CellPlace {
  int column = 0;
  int row = 0;
};

/// Pixels begin to end - 1 of each axis.
struct PixelBox {
  int x_begin = 0;
  int x_end = 0;
  int y_begin = 0;
  int y_end = 0;
};

/// Square cells that a picture is parted into; those at its right and lower edge may be cut. What
/// changes slowly from pixel to pixel is kept a cell, or at the nodes, which are the cells'
/// corners.
class CellGrid {
 public:
  static constexpr int kCellPx = 8;  // even, for chroma

  CellGrid() = default;
  explicit CellGrid(ImageSize picture)
      : picture_(picture),
        columns_((picture.width + kCellPx - 1) / kCellPx),
        rows_((picture.height + kCellPx - 1) / kCellPx) {}

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] std::size_t cells() const {
    return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  }
  [[nodiscard]] std::size_t nodes() const {
    return static_cast<std::size_t>(columns_ + 1) * static_cast<std::size_t>(rows_ + 1);
  }

  [[nodiscard]] std::size_t index(CellPlace cell) const {
    return static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(cell.column);
  }

  /// Of a cell's upper left corner; the last column and row are corners only.
  [[nodiscard]] std::size_t node_index(CellPlace cell) const {
    return static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(columns_ + 1) +
           static_cast<std::size_t>(cell.column);
  }

  /// Upper left, upper right, lower left, lower right.
  [[nodiscard]] std::array<std::size_t, 4> corners(CellPlace cell) const {
    const std::size_t upper = node_index(cell);
    const std::size_t lower = node_index({cell.column, cell.row + 1});
    return {upper, upper + 1, lower, lower + 1};
  }

  /// Coordinates of a column and of a row of nodes, in pixels.
  [[nodiscard]] double node_x(int column) const { return x_begin(column) - 0.5; }
  [[nodiscard]] double node_y(int row) const { return y_begin(row) - 0.5; }

  [[nodiscard]] PixelBox pixels(CellPlace cell) const {
    return {x_begin(cell.column), x_begin(cell.column + 1), y_begin(cell.row),
            y_begin(cell.row + 1)};
  }

  template <typename Visit>
  void for_each_cell(Visit&& visit) const {
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) visit(CellPlace{column, row});
    }
  }

 private:
  [[nodiscard]] int x_begin(int column) const { return std::min(column * kCellPx, picture_.width); }
  [[nodiscard]] int y_begin(int row) const { return std::min(row * kCellPx, picture_.height); }

  ImageSize picture_;
  int columns_ = 0;
  int rows_ = 0;
};

/// One number a node.
using NodeField = std::vector<float>;

/// A node's number is the mean of the cells around it.
[[nodiscard]] NodeField mean_at_nodes(const CellGrid& grid, const std::vector<float>& of_cells);

[[nodiscard]] float least_corner(const CellGrid& grid, const NodeField& field, CellPlace cell);
[[nodiscard]] float greatest_corner(const CellGrid& grid, const NodeField& field, CellPlace cell);

/// A node field inside one cell, bilinear between its corners.
class CellPatch {
 public:
  CellPatch(const CellGrid& grid, const NodeField& field, CellPlace cell);

  /// At the centre of the pixel so far from the cell's upper left one.
  [[nodiscard]] float at(int x, int y) const {
    const float down = (static_cast<float>(y) + 0.5F) * per_row_;
    const float left = upper_left_ + down * left_fall_;
    const float right = upper_right_ + down * right_fall_;
    return left + (static_cast<float>(x) + 0.5F) * per_column_ * (right - left);
  }

 private:
  float upper_left_;
  float upper_right_;
  float left_fall_;
  float right_fall_;
  float per_column_;
  float per_row_;
};

}  // namespace gimbal
