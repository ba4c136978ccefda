#include "tests/judge/frame_border.hpp"

#include <opencv2/imgproc.hpp>
#include <vector>

namespace gimbal::judge {
namespace {

constexpr int kMostBlack = 18;  // 16, and what lossy coding adds

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

}  // namespace gimbal::judge
