#include "tests/judge/frame_border.hpp"

#include <opencv2/imgproc.hpp>
#include <vector>

namespace gimbal::judge {
namespace {

constexpr int kMostBlack = 18;  // 16, and what lossy coding adds
constexpr int kMostDark = 28;   // of an original that may have become black by being drawn again
constexpr int kNext_px = 4;     // that a homography may be off

bool is_at_edge(const cv::Mat& stats, int label, cv::Size size) {
  const int left = stats.at<int>(label, cv::CC_STAT_LEFT);
  const int top = stats.at<int>(label, cv::CC_STAT_TOP);
  return left == 0 || top == 0 || left + stats.at<int>(label, cv::CC_STAT_WIDTH) == size.width ||
         top + stats.at<int>(label, cv::CC_STAT_HEIGHT) == size.height;
}

}  // namespace

cv::Mat black_border(const cv::Mat& luma) {
  const cv::Mat black = luma <= kMostBlack;
  if (cv::countNonZero(black) == 0) return black;
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centroids;
  const int count = cv::connectedComponentsWithStats(black, labels, stats, centroids, 4);
  std::vector<unsigned char> value(static_cast<std::size_t>(count), 0);
  for (int label = 1; label < count; ++label) {
    if (is_at_edge(stats, label, luma.size())) value[static_cast<std::size_t>(label)] = 255;
  }
  cv::Mat border(luma.size(), CV_8UC1);
  for (int row = 0; row < luma.rows; ++row) {
    for (int column = 0; column < luma.cols; ++column) {
      border.at<unsigned char>(row, column) =
          value[static_cast<std::size_t>(labels.at<int>(row, column))];
    }
  }
  return border;
}

cv::Mat without_dark_scene(const cv::Mat& border, const cv::Mat& original,
                           const cv::Matx33d& H_original_output) {
  cv::Mat shown;
  cv::warpPerspective(original, shown, H_original_output, border.size(),
                      cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT, 255);
  const cv::Mat dark = shown <= kMostDark;
  cv::Mat near_dark;
  const cv::Size reach(2 * kNext_px + 1, 2 * kNext_px + 1);
  cv::dilate(dark, near_dark, cv::getStructuringElement(cv::MORPH_RECT, reach));
  cv::Mat left = border.clone();
  left.setTo(0, near_dark);
  return left;
}

}  // namespace gimbal::judge
