#include "pipeline/sync/small_picture.hpp"

#include <cstddef>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pipeline/sync/feature_tracker.hpp"

namespace gimbal {
namespace {

VideoFrame as_frame(const SmallPicture& picture) {
  VideoFrame frame;
  frame.stamp = picture.stamp;
  frame.size = picture.size;
  frame.planes[0] = {picture.luma.data(), picture.size.width};
  return frame;
}

}  // namespace

SmallPicture small_picture(const VideoFrame& frame, int block_px) {
  SmallPicture small{
      frame.stamp, {frame.size.width / block_px, frame.size.height / block_px}, block_px, {}};
  small.luma.resize(static_cast<std::size_t>(small.size.width) *
                    static_cast<std::size_t>(small.size.height));
  // Whole blocks only, or the ratio would not be that of the blocks.
  const cv::Mat whole(small.size.height * block_px, small.size.width * block_px, CV_8UC1,
                      const_cast<std::uint8_t*>(frame.planes[0].data),
                      static_cast<std::size_t>(frame.planes[0].stride_bytes));
  cv::Mat averaged(small.size.height, small.size.width, CV_8UC1, small.luma.data());
  cv::resize(whole, averaged, averaged.size(), 0, 0, cv::INTER_AREA);
  return small;
}

FollowedBurst follow_burst(std::span<const SmallPicture> pictures, int corners) {
  FeatureTracker tracker({.corners = corners, .renewed_below = 0});
  FollowedBurst burst;
  for (const SmallPicture& picture : pictures) {
    tracker.push(as_frame(picture));
    burst.frames.push_back(picture.stamp);
  }
  burst.corners = tracker.take();
  const double block_px = pictures.empty() ? 1 : pictures.front().block_px;
  for (FeatureTrack& track : burst.corners) {
    for (TrackPoint& point : track) {
      // Centres of pixels have whole coordinates, in the small picture as in the large one.
      point.px = block_px * (point.px.array() + 0.5) - 0.5;
    }
  }
  return burst;
}

void keep_to_own_thread() {
  cv::setNumThreads(1);
}

}  // namespace gimbal
