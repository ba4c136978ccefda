#include "tests/judge/frame_tracks.hpp"

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace gimbal::judge {
namespace {

constexpr int kMostCorners = 400;
constexpr double kLeastQuality = 0.005;  // of the best corner
constexpr int kCornersAcross = 32;       // that the least distance between two leaves room for
constexpr int kPyramidLevels = 4;
constexpr double kMostReturn_px = 0.2;

const cv::Size kWindow(21, 21);

std::vector<cv::Point2f> follow(const TrackedPicture& from, const TrackedPicture& to,
                                const std::vector<cv::Point2f>& points,
                                std::vector<unsigned char>& found) {
  std::vector<cv::Point2f> followed;
  std::vector<float> errors;
  cv::calcOpticalFlowPyrLK(
      from.pyramid, to.pyramid, points, followed, found, errors, kWindow, kPyramidLevels,
      cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.003));
  return followed;
}

bool is_seen(const cv::Mat& mask, const cv::Point2f& point) {
  const cv::Point pixel(cvRound(point.x), cvRound(point.y));
  return cv::Rect(0, 0, mask.cols, mask.rows).contains(pixel) && mask.at<unsigned char>(pixel) != 0;
}

}  // namespace

TrackedPicture make_tracked_picture(const cv::Mat& luma, const cv::Mat& mask) {
  TrackedPicture picture{luma, mask, {}};
  cv::buildOpticalFlowPyramid(luma, picture.pyramid, kWindow, kPyramidLevels);
  return picture;
}

std::vector<Track> track_corners(const TrackedPicture& from, const TrackedPicture& to) {
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(from.luma, corners, kMostCorners, kLeastQuality,
                          static_cast<double>(from.luma.cols) / kCornersAcross, from.mask);
  if (corners.empty()) return {};
  std::vector<unsigned char> found;
  std::vector<unsigned char> returned;
  const std::vector<cv::Point2f> there = follow(from, to, corners, found);
  const std::vector<cv::Point2f> back = follow(to, from, there, returned);
  std::vector<Track> tracks;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (found[i] == 0 || returned[i] == 0 || !is_seen(to.mask, there[i])) continue;
    if (cv::norm(back[i] - corners[i]) <= kMostReturn_px) tracks.push_back({corners[i], there[i]});
  }
  return tracks;
}

}  // namespace gimbal::judge
