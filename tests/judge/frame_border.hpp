#pragma once

#include <opencv2/core.hpp>

namespace gimbal::judge {

/// Pixels that look as if they had no source: black (luma of at most 18, of video's 16 to 235) and
/// linked to the picture's edge by black pixels. 255 there, else 0. Anyone's video can be asked
/// this, at a price: what is truly black at the edge counts, and an edge that is filled, mirrored
/// or of another colour does not.
[[nodiscard]] cv::Mat black_border(const cv::Mat& luma);

/// The border less what the original shows just as dark at that place, or next to it.
[[nodiscard]] cv::Mat without_dark_scene(const cv::Mat& border, const cv::Mat& original,
                                         const cv::Matx33d& H_original_output);

}  // namespace gimbal::judge
