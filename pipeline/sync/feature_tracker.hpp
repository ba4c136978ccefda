#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "pipeline/sample/video_frame.hpp"
#include "pipeline/sync/feature_track.hpp"

namespace gimbal {

struct FeatureTrackerSettings {
  int corners = 150;           ///< as many are followed at once
  double renewed_below = 0.8;  ///< share of these that are still followed; 0: once all are lost
};

/// Follows corners (Shi-Tomasi) from picture to picture (Kanade-Lucas-Tomasi), forth and back:
/// thesis 2.4. A corner that does not return to where it began is lost, and new ones are looked for
/// where there are none.
class FeatureTracker {
 public:
  explicit FeatureTracker(const FeatureTrackerSettings& settings = {});

  /// Frames in order, of one size; each gets the next place from 0.
  void push(const VideoFrame& frame);

  /// All tracks of two points at least; nothing afterwards.
  [[nodiscard]] std::vector<FeatureTrack> take();

 private:
  void follow(const std::vector<cv::Mat>& pyramid);
  void look_for_corners(const cv::Mat& picture);
  void end(FeatureTrack& track);

  FeatureTrackerSettings settings_;
  std::size_t next_frame_ = 0;
  std::vector<cv::Mat> pyramid_;  ///< of the last picture
  std::vector<FeatureTrack> followed_;
  std::vector<FeatureTrack> ended_;
};

}  // namespace gimbal
