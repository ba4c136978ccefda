#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pipeline/intrinsics/board.hpp"

namespace gimbal::test {

/// A ChArUco board as OpenCV prints it.
struct CharucoDrawing {
  int width = 0;
  int square_px = 0;
  std::vector<std::uint8_t> pixels;

  /// By the place from the board's corner, in squares; must lie on the board.
  [[nodiscard]] bool is_white(const Eigen::Vector2d& place) const {
    const Eigen::Array2i pixel = (place.array() * square_px).floor().cast<int>();
    return pixels[static_cast<std::size_t>(pixel.y() * width + pixel.x())] > 127;
  }
};

[[nodiscard]] CharucoDrawing draw_charuco(const CalibrationBoard& board);

}  // namespace gimbal::test
