#include "pipeline/intrinsics/charuco_view.hpp"

#include <cstddef>

namespace gimbal {

double clear_share(const CalibrationBoard& board) {
  constexpr double kCautious = 0.9;  // squares are not as near on all sides in perspective
  return kCautious * (1 - board.marker_squares) / 2;
}

BoardView charuco_view(const std::vector<cv::Point2f>& found, const std::vector<int>& numbers,
                       int corners_a_row) {
  BoardView view;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    view.corners.emplace_back(numbers[i] % corners_a_row, numbers[i] / corners_a_row);
    view.seen_px.emplace_back(found[i].x, found[i].y);
  }
  return view;
}

}  // namespace gimbal
