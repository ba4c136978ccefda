#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <vector>

#include "pipeline/intrinsics/aruco_dictionaries.hpp"
#include "pipeline/intrinsics/board_detectors.hpp"
#include "pipeline/intrinsics/charuco_view.hpp"

namespace gimbal {
namespace {

class CharucoDetector final : public BoardDetector {
 public:
  CharucoDetector(const CalibrationBoard& board, const cv::Ptr<cv::aruco::Dictionary>& dictionary)
      : BoardDetector(clear_share(board)),
        corners_a_row_(board.columns - 1),
        dictionary_(dictionary),
        board_(cv::aruco::CharucoBoard::create(
            board.columns, board.rows, 1, static_cast<float>(board.marker_squares), dictionary)) {}

 private:
  [[nodiscard]] BoardView look(const cv::Mat& luma) const override;

  int corners_a_row_;
  cv::Ptr<cv::aruco::Dictionary> dictionary_;
  cv::Ptr<cv::aruco::CharucoBoard> board_;
};

BoardView CharucoDetector::look(const cv::Mat& luma) const {
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> names;
  cv::aruco::detectMarkers(luma, dictionary_, markers, names);
  std::vector<cv::Point2f> found;
  std::vector<int> places;
  if (!names.empty()) {
    cv::aruco::interpolateCornersCharuco(markers, names, luma, board_, found, places);
  }
  return charuco_view(found, places, corners_a_row_);
}

}  // namespace

Result<std::unique_ptr<BoardDetector>> make_charuco_detector(const CalibrationBoard& board) {
  const auto number = aruco_dictionary(board.dictionary);
  if (!number) return tl::unexpected(number.error());
  const auto dictionary = cv::aruco::getPredefinedDictionary(*number);
  if (auto checked = check_markers(board, dictionary->bytesList.rows); !checked) {
    return tl::unexpected(checked.error());
  }
  return std::make_unique<CharucoDetector>(board, dictionary);
}

}  // namespace gimbal
