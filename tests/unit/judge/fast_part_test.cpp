#include "tests/judge/fast_part.hpp"

#include <gtest/gtest.h>

#include "pipeline/path/steadiness.hpp"
#include "tests/unit/judge/moving_picture.hpp"

namespace gimbal::judge {
namespace {

/// The same quantity as the stabilizer's own report tells, computed by the other's code.
TEST(FastPart, OfARateIsWhatTheReportCallsSteadiness) {
  std::vector<FramePose> poses;
  std::vector<Measured> rates_rad_s;
  double last_rad = 0;
  for (int i = 0; i < 200; ++i) {
    const double time_s = i / kFps;
    const double yaw_rad = 0.3 * sine(0.2, time_s) + 0.02 * sine(1.9, time_s) + 0.3 * time_s;
    poses.push_back({{i, time_from_seconds(time_s), std::nullopt},
                     Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()))});
    if (i > 0) {
      rates_rad_s.push_back({(i - 0.5) / kFps, {0, kFps * (yaw_rad - last_rad), 0}});
    }
    last_rad = yaw_rad;
  }
  const double expected = rms_rate_above_rad_s(poses, 1.0);
  EXPECT_NEAR(rms_length(fast_part(rates_rad_s, 1.0)), expected, 1e-6 * expected);
}

TEST(FastPart, OfAConstantIsNoneAcrossAGap) {
  const std::vector<Measured> series = {{0, {2, 1, 0}}, {0.1, {2, 1, 0}}, {5, {2, 1, 0}}};
  EXPECT_NEAR(rms_length(fast_part(series, 1.0)), 0, 1e-12);
}

TEST(FastPart, OfNothingIsNothing) {
  EXPECT_EQ(rms_length(fast_part({}, 1.0)), 0);
}

}  // namespace
}  // namespace gimbal::judge
