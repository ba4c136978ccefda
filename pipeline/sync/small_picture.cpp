#include "pipeline/sync/small_picture.hpp"

#include <algorithm>
#include <cstddef>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "pipeline/sync/feature_tracker.hpp"

namespace gimbal {
namespace {

constexpr const char* kNoPicture = "there is nothing in the picture";

VideoFrame as_frame(const SmallPicture& picture) {
  VideoFrame frame;
  frame.stamp = picture.stamp;
  frame.size = picture.size;
  frame.planes[0] = {picture.luma.data(), picture.size.width};
  return frame;
}

/// OpenCV looks for corners in such a one for ever.
bool is_empty(ImageSize size) {
  return size.width < 1 || size.height < 1;
}

tl::unexpected<Error> refused_by(const cv::Exception& error) {
  return failed("OpenCV, in " + error.func + ": " + error.err);
}

FollowedBurst followed(std::span<const SmallPicture> pictures, int corners) {
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

}  // namespace

Result<SmallPicture> small_picture(const VideoFrame& frame, int block_px) {
  SmallPicture small{
      frame.stamp, {frame.size.width / block_px, frame.size.height / block_px}, block_px, {}};
  small.luma.resize(static_cast<std::size_t>(small.size.width) *
                    static_cast<std::size_t>(small.size.height));
  if (is_empty(small.size)) return failed(kNoPicture);
  // Whole blocks only, or the ratio would not be that of the blocks.
  const cv::Mat whole(small.size.height * block_px, small.size.width * block_px, CV_8UC1,
                      const_cast<std::uint8_t*>(frame.planes[0].data),
                      static_cast<std::size_t>(frame.planes[0].stride_bytes));
  cv::Mat averaged(small.size.height, small.size.width, CV_8UC1, small.luma.data());
  try {
    cv::resize(whole, averaged, averaged.size(), 0, 0, cv::INTER_AREA);
  } catch (const cv::Exception& error) {
    return refused_by(error);
  }
  return small;
}

Result<FollowedBurst> follow_burst(std::span<const SmallPicture> pictures, int corners) {
  const auto differs = [&](const SmallPicture& picture) {
    return picture.size != pictures.front().size;
  };
  if (std::ranges::any_of(pictures, differs)) return failed("the pictures differ in size");
  if (!pictures.empty() && is_empty(pictures.front().size)) return failed(kNoPicture);
  try {
    return followed(pictures, corners);
  } catch (const cv::Exception& error) {
    return refused_by(error);
  }
}

void keep_to_own_thread() {
  cv::setNumThreads(1);
}

}  // namespace gimbal
