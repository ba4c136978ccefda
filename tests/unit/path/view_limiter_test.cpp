#include "pipeline/path/view_limiter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "pipeline/path/pose_filter.hpp"
#include "pipeline/path/steadiness.hpp"

namespace gimbal {
namespace {

using Eigen::Quaterniond;

Quaterniond yaw(double angle_rad) {
  return Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitY()));
}

/// A frame seen straight needs zoom 1; a view turned by an angle away from it needs 1 + angle.
WantedView wanted(std::int64_t index, double steady_away_rad) {
  return {{{index, time_from_seconds(static_cast<double>(index) / 30), std::nullopt}, yaw(0)},
          yaw(steady_away_rad),
          [](const Quaterniond& q) { return 1 + q.angularDistance(yaw(0)); }};
}

std::vector<SteadyView> run(ViewLimiter& limiter, const std::vector<double>& angles_rad) {
  std::vector<SteadyView> views;
  const auto take = [&] {
    while (auto view = limiter.pop()) views.push_back(*view);
  };
  for (std::size_t i = 0; i < angles_rad.size(); ++i) {
    limiter.push(wanted(static_cast<std::int64_t>(i), angles_rad[i]));
    take();
  }
  limiter.finish();
  take();
  return views;
}

double angle_of(const SteadyView& view) {
  return view.steady.q_world_camera.angularDistance(yaw(0));
}

TEST(ViewLimiter, LeavesViewsThatFit) {
  ViewLimiter limiter({1.2, 1.2}, std::nullopt);
  const auto views = run(limiter, {0.01, 0.1, 0.19});
  ASSERT_EQ(views.size(), 3U);
  EXPECT_NEAR(angle_of(views[2]), 0.19, 1e-9);
  EXPECT_EQ(views[0].zoom, 1.2);
}

TEST(ViewLimiter, AutomaticZoomIsTheLeastThatShowsAllAndConstant) {
  ViewLimiter limiter({1, 1.5}, std::nullopt);
  const auto views = run(limiter, {0.02, 0.1, 0.05});
  for (const SteadyView& view : views) EXPECT_NEAR(view.zoom, 1.1, 2e-3);
}

class AnyLatency : public ::testing::TestWithParam<PathLatency> {};

TEST_P(AnyLatency, NoViewExceedsItsFrame) {
  ViewLimiter limiter({1, 1.1}, GetParam());
  std::vector<double> angles_rad(90, 0.02);
  std::fill(angles_rad.begin() + 40, angles_rad.begin() + 50, 0.5);
  const auto views = run(limiter, angles_rad);
  ASSERT_EQ(views.size(), angles_rad.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    EXPECT_EQ(views[i].steady.stamp.index, static_cast<std::int64_t>(i));
    EXPECT_LE(1 + angle_of(views[i]), views[i].zoom);
    if (i > 0) {
      EXPECT_GE(views[i].zoom, views[i - 1].zoom);
    }
  }
  // Not needlessly far from the steady view either, once it fits again.
  EXPECT_NEAR(angle_of(views.back()), 0.02, 1e-9);
  // Nor where it does not, unless all is known: then the real camera, which stands still here,
  // leads.
  if (GetParam()) {
    EXPECT_GT(angle_of(views[45]), 0.09);
  }
}

INSTANTIATE_TEST_SUITE_P(ViewLimiter, AnyLatency,
                         ::testing::Values(PathLatency{}, PathLatency{0}, PathLatency{5}));

TEST(ViewLimiter, TurnsBackGraduallyWhenAllIsKnown) {
  ViewLimiter limiter({1.1, 1.1}, std::nullopt);
  std::vector<double> angles_rad(60, 0.1);
  angles_rad[30] = 1.0;
  const auto views = run(limiter, angles_rad);
  for (std::size_t i = 1; i < views.size(); ++i) {
    if (i == 30 || i == 31) continue;  // the wanted view itself jumps there
    EXPECT_LE(std::abs(angle_of(views[i]) - angle_of(views[i - 1])), 0.011) << i;
  }
}

/// The yaw of a camera that swings by +-0.3 rad at 0.5 Hz, with a tremor of 0.01 rad at 8 Hz.
double shaky_yaw_rad(int frame) {
  const double t = frame / 30.0;
  return 0.3 * std::sin(std::numbers::pi * t) + 0.01 * std::sin(16 * std::numbers::pi * t);
}

FramePose pose(std::int64_t index, double yaw_rad) {
  return {{index, time_from_seconds(static_cast<double>(index) / 30), std::nullopt}, yaw(yaw_rad)};
}

TEST(ViewLimiter, BringsBackLessShakeThanTurningEachFrameBackAlone) {
  constexpr int kFrames = 240;
  constexpr double kReach_rad = 0.15;
  ViewLimiter limiter({1 + kReach_rad, 1 + kReach_rad}, std::nullopt);
  // What turns each frame's view, which stands still, no further back than that frame needs shows
  // the whole tremor for as long as the camera is out of reach.
  std::vector<FramePose> turned_alone;
  for (int i = 0; i < kFrames; ++i) {
    const double real_rad = shaky_yaw_rad(i);
    limiter.push({pose(i, real_rad), yaw(0), [real_rad](const Quaterniond& q) {
                    return 1 + q.angularDistance(yaw(real_rad));
                  }});
    turned_alone.push_back(pose(i, std::clamp(0.0, real_rad - kReach_rad, real_rad + kReach_rad)));
  }
  limiter.finish();
  std::vector<FramePose> limited;
  while (const auto view = limiter.pop()) {
    const double real_rad = shaky_yaw_rad(static_cast<int>(limited.size()));
    EXPECT_LE(view->steady.q_world_camera.angularDistance(yaw(real_rad)), kReach_rad);
    limited.push_back(view->steady);
  }
  ASSERT_EQ(limited.size(), turned_alone.size());
  // Between swing and tremor; less than half of the power, that is 3 dB, counts as less.
  EXPECT_LT(rms_rate_above_rad_s(limited, 4),
            rms_rate_above_rad_s(turned_alone, 4) / std::numbers::sqrt2);
}

/// Held almost still for some seconds, then swung up and down: steadied by far more than fits.
std::vector<double> held_then_swung_rad() {
  constexpr double kSwing_rad = 0.35;
  std::vector<double> angles_rad;
  for (int i = 0; i < 300; ++i) {
    const double swung_s = std::max(0.0, i / 30.0 - 3);
    angles_rad.push_back(0.02 * std::sin(i / 30.0) +
                         kSwing_rad * (1 - std::cos(2 * std::numbers::pi * 0.6 * swung_s)));
  }
  return angles_rad;
}

/// The largest change of the rate from a frame to the next, in radians a frame.
double largest_jerk_rad(const std::vector<double>& angles_rad) {
  double largest = 0;
  for (std::size_t i = 2; i < angles_rad.size(); ++i) {
    largest =
        std::max(largest, std::abs(angles_rad[i] - 2 * angles_rad[i - 1] + angles_rad[i - 2]));
  }
  return largest;
}

TEST(ViewLimiter, MovesNoMoreSuddenlyThanTheCameraDid) {
  const std::vector<double> real_rad = held_then_swung_rad();
  ViewLimiter limiter({1.05, 1.05}, std::nullopt);
  auto path = make_hann_filter(99, std::nullopt);
  std::vector<FramePose> real;
  for (std::size_t i = 0; i < real_rad.size(); ++i) {
    const auto index = static_cast<std::int64_t>(i);
    real.push_back(
        {{index, time_from_seconds(static_cast<double>(i) / 30), std::nullopt}, yaw(real_rad[i])});
    path->push(real.back());
  }
  path->finish();
  for (const FramePose& pose : real) {
    limiter.push({pose, path->pop()->q_world_camera, [pose](const Quaterniond& q) {
                    return 1 + q.angularDistance(pose.q_world_camera);
                  }});
  }
  limiter.finish();
  std::vector<double> written_rad;
  while (const auto view = limiter.pop()) {
    const Quaterniond& q = view->steady.q_world_camera;
    written_rad.push_back(2 * std::atan2(q.y(), q.w()));
  }
  ASSERT_EQ(written_rad.size(), real_rad.size());
  constexpr double kUnseen = 1.1;
  EXPECT_LE(largest_jerk_rad(written_rad), kUnseen * largest_jerk_rad(real_rad));
}

TEST(ViewLimiter, AFrameThatNothingFitsGetsItsRealView) {
  ViewLimiter limiter({1, 1}, std::nullopt);
  const auto views = run(limiter, {0.3});
  EXPECT_EQ(angle_of(views[0]), 0);
}

}  // namespace
}  // namespace gimbal
