#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/intrinsics/board.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// How a board lies in the picture, as far as that can be told without knowing the lens.
struct ViewShape {
  Eigen::Vector2d middle;  ///< of what is seen, in widths and heights of the picture
  double size = 0;         ///< root of the share of the picture's area
  /// Towards which side of the picture the board comes nearer: how much larger its squares are
  /// there, as the logarithm of their area from one end of the board to the other.
  Eigen::Vector2d tilt;
};

[[nodiscard]] ViewShape shape_of(const BoardView& view, ImageSize size);

/// Of the views of a video some that differ: each new one far enough from those before, or the
/// sharper of two that are alike. Holds a few dozen, however many are offered.
class ViewChoice {
 public:
  enum class Pictures : std::uint8_t {
    chosen,  ///< somebody has taken each on purpose: all are kept, up to the most
    running,
  };

  ViewChoice(ImageSize size, Pictures pictures);

  /// Whether it is among the views now.
  bool offer(BoardView view);

  [[nodiscard]] const std::vector<BoardView>& views() const { return views_; }

 private:
  [[nodiscard]] std::size_t least_useful() const;

  ImageSize size_;
  double spacing_;
  std::vector<BoardView> views_;
  std::vector<ViewShape> shapes_;  ///< of the views
};

}  // namespace gimbal
