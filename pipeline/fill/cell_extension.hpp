#pragma once

#include <Eigen/Core>
#include <vector>

#include "pipeline/fill/cell_grid.hpp"

namespace gimbal {

/// What is known of a cell, and how well: weight 0 for nothing, 1 for certain.
struct CellValues {
  Eigen::Array4f values = Eigen::Array4f::Zero();
  float weight = 0;
};

/// Carries on what is known of some cells to those of which less is, ever smoother the farther away
/// (push-pull; Gortler et al., "The Lumigraph", 1996). Cells of weight 1 stay as they are. Where
/// nothing is known at all, zero.
void extend(const CellGrid& grid, std::vector<CellValues>& cells);

/// The first three values, at the nodes.
[[nodiscard]] std::array<NodeField, 3> fields_of(const CellGrid& grid,
                                                 const std::vector<CellValues>& cells);

}  // namespace gimbal
