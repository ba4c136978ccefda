#include "tests/support/charuco_drawing.hpp"

#include <opencv2/core.hpp>
#include <stdexcept>

#include "pipeline/intrinsics/aruco_dictionaries.hpp"

#if !defined(GIMBALD_HAS_CHARUCO)
// Nothing can be drawn.
#elif CV_VERSION_MAJOR * 100 + CV_VERSION_MINOR >= 407
#include <opencv2/objdetect/aruco_board.hpp>
#include <opencv2/objdetect/aruco_dictionary.hpp>
#else
#include <opencv2/aruco/charuco.hpp>
#endif

namespace gimbal::test {
namespace {

constexpr int kSquare_px = 60;

#if !defined(GIMBALD_HAS_CHARUCO)
cv::Mat draw(const CalibrationBoard&, cv::Size) {
  throw std::logic_error("built without OpenCV's ArUco");
}
#elif CV_VERSION_MAJOR * 100 + CV_VERSION_MINOR >= 407
cv::Mat draw(const CalibrationBoard& board, cv::Size size) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(*aruco_dictionary(board.dictionary));
  cv::Mat image;
  cv::aruco::CharucoBoard({board.columns, board.rows}, 1, static_cast<float>(board.marker_squares),
                          dictionary)
      .generateImage(size, image);
  return image;
}
#else
cv::Mat draw(const CalibrationBoard& board, cv::Size size) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(*aruco_dictionary(board.dictionary));
  cv::Mat image;
  cv::aruco::CharucoBoard::create(board.columns, board.rows, 1,
                                  static_cast<float>(board.marker_squares), dictionary)
      ->draw(size, image);
  return image;
}
#endif

}  // namespace

CharucoDrawing draw_charuco(const CalibrationBoard& board) {
  const cv::Mat image = draw(board, {kSquare_px * board.columns, kSquare_px * board.rows});
  return {image.cols, kSquare_px, {image.begin<std::uint8_t>(), image.end<std::uint8_t>()}};
}

}  // namespace gimbal::test
