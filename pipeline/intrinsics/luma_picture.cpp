#include "pipeline/intrinsics/luma_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace gimbal {
namespace {

constexpr int kReach_px = 5;
constexpr double kLeastReach_px = 2;
constexpr double kMostReach_px = 11;

/// Nothing (0) where the corner is too close to the border, or without contrast.
double sharpness_at(const cv::Mat& luma, const Eigen::Vector2d& corner_px) {
  const int left = static_cast<int>(std::lround(corner_px.x())) - kReach_px;
  const int top = static_cast<int>(std::lround(corner_px.y())) - kReach_px;
  constexpr int kSide = 2 * kReach_px + 1;
  if (left < 0 || top < 0 || left + kSide > luma.cols || top + kSide > luma.rows) return 0;
  int darkest = 255;
  int brightest = 0;
  double steepest = 0;
  for (int y = top; y + 1 < top + kSide; ++y) {
    const auto* const row = luma.ptr<std::uint8_t>(y);
    const auto* const below = luma.ptr<std::uint8_t>(y + 1);
    for (int x = left; x + 1 < left + kSide; ++x) {
      darkest = std::min<int>(darkest, row[x]);
      brightest = std::max<int>(brightest, row[x]);
      steepest = std::max(steepest, std::hypot(row[x + 1] - row[x], below[x] - row[x]));
    }
  }
  return brightest > darkest ? steepest / (brightest - darkest) : 0;
}

/// Half the side of the square around a corner in which no other corner's edges lie.
int free_reach_px(const std::vector<Eigen::Vector2d>& corners_px, std::size_t of,
                  double clear_share) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corners_px.size(); ++i) {
    if (i != of) nearest = std::min(nearest, (corners_px[i] - corners_px[of]).norm());
  }
  return static_cast<int>(std::clamp(nearest * clear_share, kLeastReach_px, kMostReach_px));
}

}  // namespace

void refine_corners(const cv::Mat& luma, double clear_share,
                    std::vector<Eigen::Vector2d>& corners_px) {
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 40, 1e-3);
  const std::vector<Eigen::Vector2d> found = corners_px;
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::vector<cv::Point2f> corner = {cv::Point2d(found[i].x(), found[i].y())};
    const int reach = free_reach_px(found, i, clear_share);
    cv::cornerSubPix(luma, corner, {reach, reach}, {-1, -1}, until);
    corners_px[i] = {corner[0].x, corner[0].y};
  }
}

cv::Mat luma_of(const VideoFrame& frame) {
  // OpenCV has no pictures that are read only.
  auto* const data = const_cast<std::uint8_t*>(frame.planes[0].data);  // NOLINT(*-const-cast)
  return {frame.size.height, frame.size.width, CV_8UC1, data,
          static_cast<std::size_t>(frame.planes[0].stride_bytes)};
}

double corner_sharpness(const cv::Mat& luma, std::span<const Eigen::Vector2d> corners_px) {
  if (corners_px.empty()) return 0;
  std::vector<double> all;
  for (const Eigen::Vector2d& corner_px : corners_px) all.push_back(sharpness_at(luma, corner_px));
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

}  // namespace gimbal
