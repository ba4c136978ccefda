#include "pipeline/sync/feature_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <utility>

namespace gimbal {
namespace {

constexpr int kPyramidLevels = 4;  // moves of 2^4 windows' halves, as in a quick turn of the hand
constexpr int kWindow_px = 15;     // small: within it rows differ in time
constexpr double kReturn_px = 0.3;
constexpr double kQuality = 0.01;  // of the weakest corner to the strongest (Shi and Tomasi)
constexpr int kBorder_px = 8;      // windows that leave the picture are pulled

cv::Size window() {
  return {kWindow_px, kWindow_px};
}

cv::TermCriteria iterations() {
  return {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 30, 0.003};
}

cv::Mat luma_of(const VideoFrame& frame) {
  const cv::Mat view(frame.size.height, frame.size.width, CV_8UC1,
                     const_cast<std::uint8_t*>(frame.planes[0].data),
                     static_cast<std::size_t>(frame.planes[0].stride_bytes));
  return view.clone();
}

cv::Point2f last_point(const FeatureTrack& track) {
  return {static_cast<float>(track.back().px.x()), static_cast<float>(track.back().px.y())};
}

bool is_inside(const cv::Point2f& point, const cv::Size& size) {
  const cv::Rect2f inner(kBorder_px, kBorder_px, static_cast<float>(size.width - 2 * kBorder_px),
                         static_cast<float>(size.height - 2 * kBorder_px));
  return inner.contains(point);
}

}  // namespace

FeatureTracker::FeatureTracker(const FeatureTrackerSettings& settings) : settings_(settings) {}

void FeatureTracker::push(const VideoFrame& frame) {
  const cv::Mat picture = luma_of(frame);
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(picture, pyramid, window(), kPyramidLevels);
  if (!followed_.empty()) follow(pyramid);
  pyramid_ = std::move(pyramid);
  const auto followed = static_cast<double>(followed_.size());
  if (followed_.empty() || followed < settings_.renewed_below * settings_.corners) {
    look_for_corners(picture);
  }
  ++next_frame_;
}

void FeatureTracker::follow(const std::vector<cv::Mat>& pyramid) {
  std::vector<cv::Point2f> from;
  for (const FeatureTrack& track : followed_) from.push_back(last_point(track));
  std::vector<cv::Point2f> forth;
  std::vector<cv::Point2f> back;
  std::vector<unsigned char> found_forth;
  std::vector<unsigned char> found_back;
  cv::calcOpticalFlowPyrLK(pyramid_, pyramid, from, forth, found_forth, cv::noArray(), window(),
                           kPyramidLevels, iterations());
  cv::calcOpticalFlowPyrLK(pyramid, pyramid_, forth, back, found_back, cv::noArray(), window(),
                           kPyramidLevels, iterations());
  std::vector<FeatureTrack> kept;
  for (std::size_t i = 0; i < followed_.size(); ++i) {
    const bool returned =
        found_forth[i] != 0 && found_back[i] != 0 && cv::norm(back[i] - from[i]) < kReturn_px;
    if (returned && is_inside(forth[i], pyramid.front().size())) {
      followed_[i].push_back({next_frame_, {forth[i].x, forth[i].y}});
      kept.push_back(std::move(followed_[i]));
    } else {
      end(followed_[i]);
    }
  }
  followed_ = std::move(kept);
}

void FeatureTracker::look_for_corners(const cv::Mat& picture) {
  if (std::min(picture.cols, picture.rows) <= 2 * kBorder_px) return;  // all of it is border
  // As far apart as would spread that many over the picture evenly, and half of it.
  const double apart_px = 0.5 * std::sqrt(picture.size().area() / settings_.corners);
  cv::Mat wanted(picture.size(), CV_8UC1, cv::Scalar(0));
  wanted(cv::Rect({kBorder_px, kBorder_px},
                  cv::Size(picture.cols - 2 * kBorder_px, picture.rows - 2 * kBorder_px))) = 255;
  for (const FeatureTrack& track : followed_) {
    cv::circle(wanted, last_point(track), static_cast<int>(apart_px), 0, cv::FILLED);
  }
  std::vector<cv::Point2f> corners;
  const int missing = settings_.corners - static_cast<int>(followed_.size());
  cv::goodFeaturesToTrack(picture, corners, missing, kQuality, apart_px, wanted);
  for (const cv::Point2f& corner : corners) {
    followed_.push_back({{next_frame_, {corner.x, corner.y}}});
  }
}

void FeatureTracker::end(FeatureTrack& track) {
  if (track.size() > 1) ended_.push_back(std::move(track));
}

std::vector<FeatureTrack> FeatureTracker::take() {
  for (FeatureTrack& track : followed_) end(track);
  followed_.clear();
  return std::exchange(ended_, {});
}

}  // namespace gimbal
