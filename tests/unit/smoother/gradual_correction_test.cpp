#include "pipeline/smoother/gradual_correction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace gimbal {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kInterval_s = 0.005;

/// Turns about z; the filter is wrong about x by so much.
Attitude estimate(int sample, double wrong_rad) {
  const double t_s = sample * kInterval_s;
  return {time_from_seconds(t_s), AngleAxisd(wrong_rad, Vector3d::UnitX()) *
                                      Quaterniond(AngleAxisd(t_s, Vector3d::UnitZ()))};
}

const Vector3d kRate_rad_s = Vector3d::UnitZ();

TEST(GradualCorrection, ChangesNothingWhereTheFilterFollowsTheGyroscope) {
  GradualCorrection correction(std::chrono::seconds(1));
  for (int i = 0; i < 1000; ++i) {
    const Attitude filter = estimate(i, 0);
    EXPECT_LT(correction.follow(filter, kRate_rad_s).angularDistance(filter.q_world_imu), 1e-9);
  }
}

TEST(GradualCorrection, TakesAJumpInByAndBy) {
  GradualCorrection correction(std::chrono::seconds(1));
  constexpr double kJump_rad = 3 * kDegree;
  Quaterniond before = correction.follow(estimate(0, 0), kRate_rad_s);
  for (int i = 1; i < 1400; ++i) {
    const Attitude filter = estimate(i, i < 600 ? 0 : kJump_rad);
    const Quaterniond shown = correction.follow(filter, kRate_rad_s);
    const Quaterniond turn = AngleAxisd(kInterval_s, Vector3d::UnitZ()) * before;
    EXPECT_LT(shown.angularDistance(turn), 1.2 * kInterval_s * kJump_rad) << i;
    const double passed_s = (i - 599) * kInterval_s;
    if (passed_s > 0) {
      EXPECT_NEAR(shown.angularDistance(filter.q_world_imu), kJump_rad * std::exp(-passed_s),
                  0.15 * kJump_rad);
    }
    before = shown;
  }
  EXPECT_LT(before.angularDistance(estimate(1399, kJump_rad).q_world_imu), 0.05 * kJump_rad);
}

TEST(GradualCorrection, IsLevelWithinSecondsWhereTheFilterFindsOutLate) {
  GradualCorrection correction(std::chrono::seconds(1));
  Quaterniond before = correction.follow(estimate(0, 12 * kDegree), kRate_rad_s);
  double off_rad = 0;
  for (int i = 1; i < 600; ++i) {
    const Attitude filter = estimate(i, i < 20 ? 12 * kDegree : 0);  // after a tenth of a second
    const Quaterniond shown = correction.follow(filter, kRate_rad_s);
    const Quaterniond turn = before * AngleAxisd(kInterval_s, Vector3d::UnitZ());
    // Turns by what the filter found out are seen as the camera's own.
    EXPECT_LT(shown.angularDistance(turn), 4.01 * kDegree * kInterval_s) << i;
    off_rad = shown.angularDistance(filter.q_world_imu);
    before = shown;
  }
  EXPECT_LT(off_rad, 2 * kDegree);
}

TEST(GradualCorrection, StartsAnewAfterAHole) {
  GradualCorrection correction(std::chrono::seconds(1));
  (void)correction.follow(estimate(0, 0), kRate_rad_s);
  const Attitude later = estimate(100, 30 * kDegree);
  EXPECT_LT(correction.follow(later, kRate_rad_s).angularDistance(later.q_world_imu), 1e-12);
}

}  // namespace
}  // namespace gimbal
