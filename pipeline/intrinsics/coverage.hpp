#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "pipeline/intrinsics/board.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Which parts of the picture and which tilts of the board were seen.
struct Coverage {
  static constexpr int kSide = 5;
  std::array<int, std::size_t{kSide} * kSide>
      corners{};        ///< in each part of the picture, row by row
  int nearer_left = 0;  ///< views in which the board is tilted so
  int nearer_right = 0;
  int nearer_top = 0;
  int nearer_bottom = 0;

  /// Of the picture's parts those with a corner.
  [[nodiscard]] double share() const;

  /// What is still to be shown, in words; none if all was.
  [[nodiscard]] std::vector<std::string> missing() const;
};

[[nodiscard]] Coverage coverage_of(std::span<const BoardView> views, ImageSize size);

}  // namespace gimbal
