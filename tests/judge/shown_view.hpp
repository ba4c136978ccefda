#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "tests/judge/frame_tracks.hpp"

namespace gimbal::judge {

/// How an output's picture shows the original's.
struct ShownView {
  cv::Matx33d H_original_output;  ///< px to px
  double zoom = 1;                ///< output px an original px in the output's middle
  double retained = 1;            ///< share of the original's area inside the output's outline
  double distortion = 0;  ///< 0 for a similarity: 1 - the lesser by the greater of the two scales
};

/// Compares a written picture with the original's 8-bit luma of the same instant, both of one size:
/// where the middle of the output lies is sought on pictures 160 px wide, at zooms of 0.8 to 2 and
/// rolls of up to 12°, then corners are followed from the output to the original and a homography
/// is fitted (RANSAC). Nothing if the one is not found in the other. `mask` is not 0 where the
/// output may be looked at.
///
/// Distortion is that of the one against the other: an original bent by a rolling shutter counts
/// against those who unbend it.
[[nodiscard]] std::optional<ShownView> compare_views(const cv::Mat& original,
                                                     const TrackedPicture& output);

/// Of a homography from output to original, both of that size.
[[nodiscard]] ShownView view_of(const cv::Matx33d& H_original_output, cv::Size size);

}  // namespace gimbal::judge
