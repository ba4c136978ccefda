// Pictures that nothing can be told by must neither stop nor end the daemon.

#include "pipeline/sync/corner_follower.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "pipeline/sample/video_frame.hpp"
#include "tests/support/test_pictures.hpp"

namespace gimbal {
namespace {

constexpr int kCorners = 40;

FrameStamp stamp_of(int index) {
  return {index, SensorTime(index * std::chrono::milliseconds(33)), std::nullopt};
}

SmallPicture picture_of(ImageSize size, int index) {
  const auto small = small_picture(test::test_picture(size, stamp_of(index)), 1);
  EXPECT_TRUE(small);
  return *small;
}

TEST(CornerFollower, FollowsWhatStandsStill) {
  const ImageSize size{160, 120};
  const SmallPicture picture = picture_of(size, 0);
  std::vector<SmallPicture> pictures{picture, picture};
  pictures[1].stamp = stamp_of(1);
  const auto burst = gimbald_corner_follower()->follow_burst(pictures, kCorners);
  ASSERT_TRUE(burst);
  EXPECT_FALSE(burst->corners.empty());
  for (const FeatureTrack& track : burst->corners) {
    EXPECT_LT((track.front().px - track.back().px).norm(), 0.1);
  }
}

TEST(CornerFollower, FindsNothingInPicturesThatAreHardlyMoreThanTheirBorder) {
  for (const ImageSize size :
       {ImageSize{2, 2}, {640, 2}, {2, 480}, {16, 16}, {640, 16}, {17, 17}}) {
    const std::vector<SmallPicture> pictures{picture_of(size, 0), picture_of(size, 1)};
    const auto burst = gimbald_corner_follower()->follow_burst(pictures, kCorners);
    ASSERT_TRUE(burst) << size.width << "x" << size.height << ": " << burst.error().message;
    EXPECT_TRUE(burst->corners.empty()) << size.width << "x" << size.height;
  }
}

TEST(CornerFollower, RefusesWhatHoldsNoPicture) {
  const VideoFrame low = test::test_picture({1920, 2}, stamp_of(0));
  EXPECT_FALSE(gimbald_corner_follower()->small_picture(low, block_for({1920, 1080})));
  const std::vector<SmallPicture> empty{{stamp_of(0), {}, 1, {}}, {stamp_of(1), {}, 1, {}}};
  EXPECT_FALSE(gimbald_corner_follower()->follow_burst(empty, kCorners));
}

TEST(CornerFollower, RefusesPicturesOfSeveralSizes) {
  const std::vector<SmallPicture> pictures{picture_of({160, 120}, 0), picture_of({120, 160}, 1)};
  EXPECT_FALSE(gimbald_corner_follower()->follow_burst(pictures, kCorners));
}

}  // namespace
}  // namespace gimbal
