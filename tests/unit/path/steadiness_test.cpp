#include "pipeline/path/steadiness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace gimbal {
namespace {

/// Yaw angle over time, as poses at 30 frames a second for ten seconds.
template <typename Angle>
std::vector<FramePose> turning(Angle angle_rad) {
  std::vector<FramePose> poses;
  for (int i = 0; i < 300; ++i) {
    const double time_s = i / 30.0;
    poses.push_back(
        {{i, time_from_seconds(time_s), std::nullopt},
         Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad(time_s), Eigen::Vector3d::UnitY()))});
  }
  return poses;
}

TEST(Steadiness, APanAtConstantRateHasNoShake) {
  EXPECT_NEAR(rms_rate_above_rad_s(turning([](double t) { return 1.5 * t; }), 1.0), 0, 1e-7);
}

TEST(Steadiness, FastTremorCountsWhole) {
  constexpr double kHz = 8;
  constexpr double kAmplitude_rad = 0.01;
  const double angular = 2 * std::numbers::pi * kHz;
  const auto poses = turning([&](double t) { return kAmplitude_rad * std::sin(angular * t); });
  // The rate between frames is the derivative seen through a box of one frame.
  const double box = std::sin(angular / 60) / (angular / 60);
  const double expected_rad_s = kAmplitude_rad * angular * box / std::numbers::sqrt2;
  EXPECT_NEAR(rms_rate_above_rad_s(poses, 1.0), expected_rad_s, 0.02 * expected_rad_s);
}

TEST(Steadiness, SlowSwayHardlyCounts) {
  const double angular = 2 * std::numbers::pi * 0.1;
  const auto poses = turning([&](double t) { return std::sin(angular * t); });
  EXPECT_LT(rms_rate_above_rad_s(poses, 1.0), 0.05 * angular / std::numbers::sqrt2);
}

TEST(Steadiness, TooFewPosesHaveNone) {
  EXPECT_EQ(rms_rate_above_rad_s({}, 1.0), 0);
  const auto poses = turning([](double) { return 0.0; });
  EXPECT_EQ(rms_rate_above_rad_s(std::span(poses).first(1), 1.0), 0);
}

}  // namespace
}  // namespace gimbal
