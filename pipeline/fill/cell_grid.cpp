#include "pipeline/fill/cell_grid.hpp"

namespace gimbal {

NodeField mean_at_nodes(const CellGrid& grid, const std::vector<float>& of_cells) {
  NodeField field(grid.nodes());
  const auto cell_at = [&](int column, int row) {
    return of_cells[grid.index(
        {std::clamp(column, 0, grid.columns() - 1), std::clamp(row, 0, grid.rows() - 1)})];
  };
  for (int row = 0; row <= grid.rows(); ++row) {
    for (int column = 0; column <= grid.columns(); ++column) {
      field[grid.node_index({column, row})] =
          (cell_at(column - 1, row - 1) + cell_at(column, row - 1) + cell_at(column - 1, row) +
           cell_at(column, row)) /
          4;
    }
  }
  return field;
}

float least_corner(const CellGrid& grid, const NodeField& field, CellPlace cell) {
  const auto [a, b, c, d] = grid.corners(cell);
  return std::min({field[a], field[b], field[c], field[d]});
}

float greatest_corner(const CellGrid& grid, const NodeField& field, CellPlace cell) {
  const auto [a, b, c, d] = grid.corners(cell);
  return std::max({field[a], field[b], field[c], field[d]});
}

CellPatch::CellPatch(const CellGrid& grid, const NodeField& field, CellPlace cell) {
  const auto [upper_left, upper_right, lower_left, lower_right] = grid.corners(cell);
  const PixelBox box = grid.pixels(cell);
  upper_left_ = field[upper_left];
  upper_right_ = field[upper_right];
  left_fall_ = field[lower_left] - upper_left_;
  right_fall_ = field[lower_right] - upper_right_;
  per_column_ = 1 / static_cast<float>(box.x_end - box.x_begin);
  per_row_ = 1 / static_cast<float>(box.y_end - box.y_begin);
}

}  // namespace gimbal
