#include <opencv2/objdetect/aruco_detector.hpp>
#include <opencv2/objdetect/charuco_detector.hpp>
#include <vector>

#include "pipeline/intrinsics/aruco_dictionaries.hpp"
#include "pipeline/intrinsics/board_detectors.hpp"
#include "pipeline/intrinsics/charuco_view.hpp"

namespace gimbal {
namespace {

class CharucoDetector final : public BoardDetector {
 public:
  CharucoDetector(const CalibrationBoard& board, const cv::aruco::Dictionary& dictionary)
      : BoardDetector(clear_share(board)),
        corners_a_row_(board.columns - 1),
        detector_(cv::aruco::CharucoBoard({board.columns, board.rows}, 1,
                                          static_cast<float>(board.marker_squares), dictionary)) {}

 private:
  [[nodiscard]] BoardView look(const cv::Mat& luma) const override;

  int corners_a_row_;
  cv::aruco::CharucoDetector detector_;
};

BoardView CharucoDetector::look(const cv::Mat& luma) const {
  std::vector<cv::Point2f> found;
  std::vector<int> places;
  detector_.detectBoard(luma, found, places);
  return charuco_view(found, places, corners_a_row_);
}

}  // namespace

Result<std::unique_ptr<BoardDetector>> make_charuco_detector(const CalibrationBoard& board) {
  const auto number = aruco_dictionary(board.dictionary);
  if (!number) return tl::unexpected(number.error());
  const auto dictionary = cv::aruco::getPredefinedDictionary(*number);
  if (auto checked = check_markers(board, dictionary.bytesList.rows); !checked) {
    return tl::unexpected(checked.error());
  }
  return std::make_unique<CharucoDetector>(board, dictionary);
}

}  // namespace gimbal
