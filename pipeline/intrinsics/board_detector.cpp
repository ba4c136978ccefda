#include "pipeline/intrinsics/board_detector.hpp"

#include <Eigen/Geometry>
#include <cstddef>
#include <opencv2/core.hpp>

#include "pipeline/intrinsics/board_detectors.hpp"
#include "pipeline/intrinsics/luma_picture.hpp"

namespace gimbal {
namespace {

constexpr std::size_t kFewestCorners = 6;

/// Corners of a single line say nothing of a plane.
bool spans_plane(const std::vector<Eigen::Vector2d>& corners) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : corners) box.extend(corner);
  return corners.size() >= kFewestCorners && box.sizes().minCoeff() > 0;
}

}  // namespace

std::optional<BoardView> BoardDetector::find(const VideoFrame& frame) const {
  try {
    const cv::Mat luma = luma_of(frame);
    BoardView view = look(luma);
    if (!spans_plane(view.corners)) return std::nullopt;
    refine_corners(luma, clear_share_, view.seen_px);
    view.sharpness = corner_sharpness(luma, view.seen_px);
    return view;
  } catch (const cv::Exception&) {  // of a picture that its search is not made for
    return std::nullopt;
  }
}

Result<std::unique_ptr<BoardDetector>> BoardDetector::create(const CalibrationBoard& board) {
  if (board.kind == BoardKind::charuco) return make_charuco_detector(board);
  return make_checkerboard_detector(board);
}

}  // namespace gimbal
