#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace gimbal::judge {

/// One point of the scene in two pictures, px.
struct Track {
  cv::Point2f from;
  cv::Point2f to;
};

/// Corners of `from` (Shi and Tomasi, "Good features to track", CVPR 1994), spread over the
/// picture, found again in `to` by pyramidal Lucas-Kanade and from there back to where they began,
/// within 0.2 px. Both pictures are 8-bit luma of one size. The masks are not 0 where a picture may
/// be looked at.
[[nodiscard]] std::vector<Track> track_corners(const cv::Mat& from, const cv::Mat& from_mask,
                                               const cv::Mat& to, const cv::Mat& to_mask);

}  // namespace gimbal::judge
