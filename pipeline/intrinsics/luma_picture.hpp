#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// A frame's luma as OpenCV has pictures. It shares the frame's memory and is not to be written.
[[nodiscard]] cv::Mat luma_of(const VideoFrame& frame);

/// Moves corners to where the slopes around them meet (cv::cornerSubPix). It looks as far around
/// each as `clear_share` of the way to the nearest other corner, within which nothing else may be
/// drawn.
void refine_corners(const cv::Mat& luma, double clear_share,
                    std::vector<Eigen::Vector2d>& corners_px);

/// How sharp edges at these corners are, 1 over their width in px: the median of the steepest slope
/// around a corner over the contrast there.
[[nodiscard]] double corner_sharpness(const cv::Mat& luma,
                                      std::span<const Eigen::Vector2d> corners_px);

}  // namespace gimbal
