#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace gimbal::judge {

/// One point of the scene in two pictures, px.
struct Track {
  cv::Point2f from;
  cv::Point2f to;
};

/// A picture as the tracker wants it.
struct TrackedPicture {
  cv::Mat luma;  ///< 8 bits
  cv::Mat mask;  ///< not 0 where it may be looked at
  std::vector<cv::Mat> pyramid;
};

[[nodiscard]] TrackedPicture make_tracked_picture(const cv::Mat& luma, const cv::Mat& mask);

/// Corners of `from` (Shi and Tomasi, "Good features to track", CVPR 1994), spread over the
/// picture, found again in `to`, of the same size, by pyramidal Lucas-Kanade and from there back to
/// where they began, within 0.2 px.
[[nodiscard]] std::vector<Track> track_corners(const TrackedPicture& from,
                                               const TrackedPicture& to);

}  // namespace gimbal::judge
