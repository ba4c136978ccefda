#pragma once

#include <Eigen/Core>
#include <array>

#include "pipeline/fill/cell_grid.hpp"

namespace gimbal {

/// The two planes of a picture in NV12.
using PicturePlanes = std::array<ConstPlane, 2>;

/// What a cell of a picture looks like: the mean luma of its quarters, row by row, and its mean
/// chroma, as U and V.
struct CellLook {
  std::array<float, 4> luma{};
  std::array<float, 2> chroma{};

  [[nodiscard]] float mean_luma() const { return (luma[0] + luma[1] + luma[2] + luma[3]) / 4; }

  /// To the right and down, a pixel.
  [[nodiscard]] Eigen::Vector2f luma_gradient() const {
    const auto& [a, b, c, d] = luma;
    return Eigen::Vector2f((b + d) - (a + c), (c + d) - (a + b)) / CellGrid::kCellPx;
  }
};

/// Precondition: the cell is not cut (`is_whole`).
[[nodiscard]] CellLook look_at(const PicturePlanes& picture, const CellGrid& grid, CellPlace cell);

/// Cells that the picture's edge cuts are not looked at.
[[nodiscard]] bool is_whole(const CellGrid& grid, CellPlace cell);

}  // namespace gimbal
