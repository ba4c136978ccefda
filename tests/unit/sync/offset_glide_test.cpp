#include "pipeline/sync/offset_glide.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

namespace gimbal {
namespace {

using std::chrono::milliseconds;

constexpr double kFrame_s = 1.0 / 30;

SensorTime frame_at(double time_s) {
  return time_from_seconds(time_s);
}

TEST(OffsetGlide, FollowsADriftWithoutLag) {
  OffsetGlide glide;
  SensorDuration offset{};
  SensorDuration wanted{};
  for (double time_s = 0; time_s < 10; time_s += kFrame_s) {
    wanted = duration_from_seconds(0.5e-3 * time_s);
    offset = glide.towards(wanted, frame_at(time_s));
  }
  EXPECT_NEAR(to_seconds(offset - wanted), 0, 20e-6);
}

TEST(OffsetGlide, ClosesAJumpInAFewSecondsAndWithoutAStep) {
  OffsetGlide glide;
  const SensorDuration wanted = milliseconds(-33);
  SensorDuration before = glide.towards(wanted, frame_at(0));
  EXPECT_EQ(before, SensorDuration::zero());
  for (double time_s = kFrame_s; time_s < 3; time_s += kFrame_s) {
    const SensorDuration offset = glide.towards(wanted, frame_at(time_s));
    EXPECT_LE(offset, before);
    EXPECT_GE(offset, wanted);
    EXPECT_LT(before - offset, milliseconds(3));
    before = offset;
  }
  EXPECT_NEAR(to_seconds(before - wanted), 0, 0.5e-3);
}

TEST(OffsetGlide, KeepsFramesInOrderHoweverFarItIsOff) {
  OffsetGlide glide;
  SensorTime last = SensorTime::min();
  for (double time_s = 0; time_s < 3; time_s += kFrame_s) {
    const SensorTime time =
        frame_at(time_s) + glide.towards(-std::chrono::seconds(10), frame_at(time_s));
    EXPECT_GT(time, last);
    last = time;
  }
}

TEST(OffsetGlide, DoesNotJumpAfterAGapBetweenFrames) {
  OffsetGlide glide;
  static_cast<void>(glide.towards({}, frame_at(0)));
  EXPECT_LT(glide.towards(milliseconds(10), frame_at(60)), milliseconds(3));
}

}  // namespace
}  // namespace gimbal
