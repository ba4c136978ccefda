#include "daemon/sample_rate.hpp"

#include <gtest/gtest.h>

#include <random>

namespace gimbal {
namespace {

TEST(SampleRate, IsTheStampsOwn) {
  std::mt19937 random(3);
  std::normal_distribution<double> jitter_s(0, 0.0005);
  SampleRate rate;
  for (int i = 0; i < 150; ++i) rate.add(time_from_seconds(0.008 * i));
  EXPECT_EQ(rate.rate_hz(), 0) << "too early to tell";
  for (int i = 150; i < 2000; ++i) rate.add(time_from_seconds(0.008 * i + jitter_s(random)));
  EXPECT_NEAR(rate.rate_hz(), 125, 1);
}

TEST(SampleRate, FollowsADeviceThatIsSetAnew) {
  SampleRate rate;
  double time_s = 0;
  for (int i = 0; i < 1000; ++i) rate.add(time_from_seconds(time_s += 0.01));
  for (int i = 0; i < 1500; ++i) rate.add(time_from_seconds(time_s += 0.002));
  EXPECT_NEAR(rate.rate_hz(), 500, 10);
}

TEST(SampleRate, StampsThatStepBackDoNotCount) {
  SampleRate rate;
  for (int i = 0; i < 1000; ++i) {
    rate.add(time_from_seconds(0.01 * i));
    rate.add(time_from_seconds(0.01 * i - 0.001));
  }
  EXPECT_GT(rate.rate_hz(), 0);
}

}  // namespace
}  // namespace gimbal
