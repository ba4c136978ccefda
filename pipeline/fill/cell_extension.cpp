#include "pipeline/fill/cell_extension.hpp"

namespace gimbal {
namespace {

struct Level {
  int columns;
  int rows;
  std::vector<CellValues> cells;

  [[nodiscard]] CellValues& at(int column, int row) {
    return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                 static_cast<std::size_t>(column)];
  }
  [[nodiscard]] const CellValues& held_at(int column, int row) {
    return at(std::clamp(column, 0, columns - 1), std::clamp(row, 0, rows - 1));
  }
};

/// Half as fine: the mean of four cells by their weights, which add up to 1 at most.
Level coarser(Level& fine) {
  Level level{(fine.columns + 1) / 2, (fine.rows + 1) / 2, {}};
  level.cells.resize(static_cast<std::size_t>(level.columns) *
                     static_cast<std::size_t>(level.rows));
  for (int row = 0; row < fine.rows; ++row) {
    for (int column = 0; column < fine.columns; ++column) {
      const CellValues& from = fine.at(column, row);
      CellValues& to = level.at(column / 2, row / 2);
      to.values += from.weight * from.values;
      to.weight += from.weight;
    }
  }
  for (CellValues& cell : level.cells) {
    if (cell.weight > 0) cell.values /= cell.weight;
    cell.weight = std::min(cell.weight, 1.0F);
  }
  return level;
}

/// What is missing comes from the coarser level, bilinear: a fine cell lies a quarter of a coarse
/// one from the middle of its own.
void take_missing(Level& coarse, Level& fine) {
  for (int row = 0; row < fine.rows; ++row) {
    for (int column = 0; column < fine.columns; ++column) {
      CellValues& cell = fine.at(column, row);
      if (cell.weight >= 1) continue;
      const int aside = column / 2 + (column % 2 == 0 ? -1 : 1);
      const int above = row / 2 + (row % 2 == 0 ? -1 : 1);
      const Eigen::Array4f near_row = 0.75F * coarse.held_at(column / 2, row / 2).values +
                                      0.25F * coarse.held_at(aside, row / 2).values;
      const Eigen::Array4f far_row = 0.75F * coarse.held_at(column / 2, above).values +
                                     0.25F * coarse.held_at(aside, above).values;
      const Eigen::Array4f carried = 0.75F * near_row + 0.25F * far_row;
      cell.values = cell.weight * cell.values + (1 - cell.weight) * carried;
      cell.weight = 1;
    }
  }
}

}  // namespace

void extend(const CellGrid& grid, std::vector<CellValues>& cells) {
  std::vector<Level> levels;
  levels.push_back({grid.columns(), grid.rows(), std::move(cells)});
  while (levels.back().columns > 1 || levels.back().rows > 1) {
    levels.push_back(coarser(levels.back()));
  }
  for (std::size_t i = levels.size() - 1; i > 0; --i) take_missing(levels[i], levels[i - 1]);
  cells = std::move(levels.front().cells);
}

std::array<NodeField, 3> fields_of(const CellGrid& grid, const std::vector<CellValues>& cells) {
  std::array<NodeField, 3> fields;
  std::vector<float> of_cells(cells.size());
  for (std::size_t i = 0; i < fields.size(); ++i) {
    for (std::size_t cell = 0; cell < cells.size(); ++cell) {
      of_cells[cell] = cells[cell].values[static_cast<Eigen::Index>(i)];
    }
    fields[i] = mean_at_nodes(grid, of_cells);
  }
  return fields;
}

}  // namespace gimbal
