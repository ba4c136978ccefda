#include "pipeline/fill/past_frames.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace gimbal {
namespace {

VideoFrame frame(std::int64_t index) {
  VideoFrame frame;
  frame.stamp = {index, time_from_seconds(static_cast<double>(index) / 30), std::nullopt};
  return frame;
}

TEST(PastFrames, KeepsFewerOfThoseLongAgo) {
  PastFrames past;
  for (int i = 0; i <= 100; ++i) {
    past.push(frame(i));
    EXPECT_LE(past.frames().size(), 16U);
  }
  std::vector<std::int64_t> indices;
  for (const VideoFrame& kept : past.frames()) indices.push_back(kept.stamp.index);
  EXPECT_EQ(indices, (std::vector<std::int64_t>{72, 76, 80, 84, 86, 88, 90, 92, 93, 94, 95, 96, 97,
                                                98, 99, 100}));
}

TEST(PastFrames, KeepNothingOfACameraThatCountsAnew) {
  PastFrames past;
  for (int i = 1000; i < 1050; ++i) past.push(frame(i));
  past.push(frame(0));
  EXPECT_EQ(past.frames().size(), 1U);
}

}  // namespace
}  // namespace gimbal
