#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "pipeline/intrinsics/board.hpp"

namespace gimbal {

/// How far the markers are from the corners: see BoardDetector.
[[nodiscard]] double clear_share(const CalibrationBoard& board);

/// Corners that OpenCV has found, with their numbers: row by row over the board.
[[nodiscard]] BoardView charuco_view(const std::vector<cv::Point2f>& found,
                                     const std::vector<int>& numbers, int corners_a_row);

}  // namespace gimbal
