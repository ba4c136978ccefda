#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "pipeline/intrinsics/board_detectors.hpp"

namespace gimbal {
namespace {

constexpr double kClearShare = 0.45;
/// The search's time grows with the picture, while squares of ten pixels are enough for it.
constexpr double kLargestSide_px = 960;

class CheckerboardDetector final : public BoardDetector {
 public:
  explicit CheckerboardDetector(const CalibrationBoard& board)
      : BoardDetector(kClearShare), board_(board) {}

 private:
  [[nodiscard]] BoardView look(const cv::Mat& luma) const override;

  CalibrationBoard board_;
};

BoardView CheckerboardDetector::look(const cv::Mat& luma) const {
  const double scale = std::max(1.0, std::max(luma.cols, luma.rows) / kLargestSide_px);
  cv::Mat small = luma;
  if (scale > 1) cv::resize(luma, small, {}, 1 / scale, 1 / scale, cv::INTER_AREA);
  BoardView view;
  std::vector<cv::Point2f> found;
  if (!cv::findChessboardCornersSB(small, {board_.columns, board_.rows}, found,
                                   cv::CALIB_CB_NORMALIZE_IMAGE)) {
    return view;
  }
  for (int row = 0; row < board_.rows; ++row) {
    for (int column = 0; column < board_.columns; ++column) view.corners.emplace_back(column, row);
  }
  for (const cv::Point2f& corner : found) {
    view.seen_px.emplace_back((corner.x + 0.5) * scale - 0.5, (corner.y + 0.5) * scale - 0.5);
  }
  return view;
}

}  // namespace

std::unique_ptr<BoardDetector> make_checkerboard_detector(const CalibrationBoard& board) {
  return std::make_unique<CheckerboardDetector>(board);
}

}  // namespace gimbal
