#include "pipeline/path/bounded_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "drivers/synthetic/hand_motion.hpp"
#include "pipeline/path/steadiness.hpp"
#include "pipeline/warp/frame_outline.hpp"

namespace gimbal {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kFps = 30;
constexpr ImageSize kSize{1280, 720};

/// A phone's view, 55 degrees wide, with a global shutter.
const Lens& lens() {
  static const Lens made = [] {
    LensParameters parameters;
    parameters.K << 1220, 0, 639.5, 0, 1220, 359.5, 0, 0, 1;
    return *Lens::create(parameters);
  }();
  return made;
}

OutputProjection projection() {
  return {OutputLens::rectilinear, lens(), {1220, 1220, 639.5, 359.5}};
}

PathFrame frame_of(const FramePose& pose) {
  FrameOutline outline = trace_outline(
      lens(), kSize, ReadoutDirection::top_down, [&](double) { return pose.q_world_camera; }, 5);
  const ViewRoom room = view_room(outline, pose.q_world_camera, projection(), kSize);
  return {pose, room, [outline = std::move(outline)](const Quaterniond& q_world_camera) {
            return required_zoom(outline, q_world_camera, projection(), kSize);
          }};
}

FramePose pose_at(std::int64_t index, const Quaterniond& q_world_camera, double fps = kFps) {
  return {{index, time_from_seconds(100 + static_cast<double>(index) / fps), std::nullopt},
          q_world_camera};
}

std::vector<FramePose> clip(const HandModel& hand, int seconds, double fps = kFps) {
  const Motion motion = make_hand_motion(hand, std::chrono::seconds(seconds), 1);
  std::vector<FramePose> poses;
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(seconds * fps); ++i) {
    poses.push_back(
        pose_at(i, motion.at(time_from_seconds(static_cast<double>(i) / fps)).q_world_camera, fps));
  }
  return poses;
}

template <typename YawAt>
std::vector<FramePose> yawing(int frames, YawAt yaw_rad_at) {
  std::vector<FramePose> poses;
  for (std::int64_t i = 0; i < frames; ++i) {
    const double yaw_rad = yaw_rad_at(static_cast<double>(i) / kFps);
    poses.push_back(pose_at(i, Quaterniond(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitY()))));
  }
  return poses;
}

double yaw_of(const FramePose& pose) {
  return 2 * std::atan2(pose.q_world_camera.y(), pose.q_world_camera.w());
}

std::vector<SteadyView> views_of(CameraPath& path, const std::vector<FramePose>& real) {
  std::vector<SteadyView> views;
  const auto take = [&] {
    while (const auto view = path.pop()) views.push_back(*view);
  };
  for (const FramePose& pose : real) {
    path.push(frame_of(pose));
    take();
  }
  path.finish();
  take();
  return views;
}

std::vector<SteadyView> bounded(const std::vector<FramePose>& real, PathLatency latency,
                                ZoomChoice zoom = {1.15, 1.15}, double amount = 1) {
  BoundedPath path({amount, {}}, zoom, latency);
  return views_of(path, real);
}

std::vector<FramePose> poses_of(const std::vector<SteadyView>& views) {
  std::vector<FramePose> poses;
  for (const SteadyView& view : views) poses.push_back(view.steady);
  return poses;
}

double shake(const std::vector<SteadyView>& views) {
  return rms_rate_above_rad_s(poses_of(views), 1);
}

class BoundedPathOfLatency : public ::testing::TestWithParam<PathLatency> {};

std::string name_of(const ::testing::TestParamInfo<PathLatency>& info) {
  return info.param ? std::to_string(*info.param) + "_frames" : "full";
}

INSTANTIATE_TEST_SUITE_P(Any, BoundedPathOfLatency,
                         ::testing::Values(PathLatency{0}, PathLatency{5}, PathLatency{15},
                                           PathLatency{}),
                         name_of);

class BoundedPathThatLooksAhead : public BoundedPathOfLatency {};

INSTANTIATE_TEST_SUITE_P(Any, BoundedPathThatLooksAhead,
                         ::testing::Values(PathLatency{5}, PathLatency{15}, PathLatency{}),
                         name_of);

TEST(BoundedPath, UsesAndHoldsAsManyFramesOfFutureAsItMay) {
  constexpr std::size_t kLatency = 5;
  BoundedPath path({}, {1.15, 1.15}, kLatency);
  const auto real = clip(walking_hand(), 2);
  for (std::size_t i = 0; i < real.size(); ++i) {
    path.push(frame_of(real[i]));
    const auto view = path.pop();
    ASSERT_EQ(view.has_value(), i >= kLatency) << i;
    if (view) {
      EXPECT_EQ(view->steady.stamp.index, real[i - kLatency].stamp.index);
    }
    EXPECT_FALSE(path.pop());
  }
}

TEST_P(BoundedPathOfLatency, NothingLaterThanTheLatencyMatters) {
  if (!GetParam()) GTEST_SKIP() << "uses all of the future";
  const auto real = clip(walking_hand(), 3);
  auto other = real;
  constexpr std::size_t kSame = 60;
  for (std::size_t i = kSame; i < other.size(); ++i) {
    other[i].q_world_camera = Quaterniond::Identity();
  }
  const auto views = bounded(real, GetParam());
  const auto others = bounded(other, GetParam());
  for (std::size_t i = 0; i + *GetParam() < kSame; ++i) {
    EXPECT_EQ(views[i].steady.q_world_camera.coeffs(), others[i].steady.q_world_camera.coeffs());
  }
}

TEST_P(BoundedPathOfLatency, EveryViewFitsItsFrame) {
  const auto turning = yawing(150, [](double t_s) { return 7 * t_s; });
  for (const auto& real : {clip(walking_hand(), 10), clip(running_hand(), 10),
                           clip(panning_hand(), 10), clip(vehicle_mount(), 5), turning}) {
    for (const double zoom : {1.02, 1.1, 1.25}) {
      const auto views = bounded(real, GetParam(), {zoom, zoom});
      ASSERT_EQ(views.size(), real.size());
      for (std::size_t i = 0; i < views.size(); ++i) {
        EXPECT_EQ(views[i].steady.stamp.index, real[i].stamp.index);
        EXPECT_EQ(views[i].zoom, zoom);
        EXPECT_LE(frame_of(real[i]).required_zoom(views[i].steady.q_world_camera), zoom) << i;
      }
    }
  }
}

TEST_P(BoundedPathOfLatency, AmountZeroLeavesPosesAsTheyAre) {
  const auto real = clip(walking_hand(), 3);
  const auto views = bounded(real, GetParam(), {1.15, 1.15}, 0);
  for (std::size_t i = 0; i < real.size(); ++i) {
    EXPECT_LT(views[i].steady.q_world_camera.angularDistance(real[i].q_world_camera), 1e-6) << i;
  }
}

TEST_P(BoundedPathOfLatency, MoreOfItIsSteadier) {
  const auto real = clip(walking_hand(), 10);
  const double none = shake(bounded(real, GetParam(), {1.15, 1.15}, 0));
  const double some = shake(bounded(real, GetParam(), {1.15, 1.15}, 0.3));
  const double all = shake(bounded(real, GetParam(), {1.15, 1.15}, 1));
  EXPECT_LT(some, 0.8 * none);
  EXPECT_LT(all, 0.8 * some);
}

TEST_P(BoundedPathOfLatency, ATripodIsLeftAlone) {
  const auto real = clip(tripod(), 3);
  for (const SteadyView& view : bounded(real, GetParam(), {1, 1.25})) {
    EXPECT_LT(view.steady.q_world_camera.angularDistance(real[0].q_world_camera), 1e-9);
    EXPECT_EQ(view.zoom, 1);
  }
}

TEST(BoundedPath, LeavesAtMostSevenTenthsOfTheThesisShake) {
  const auto real = clip(walking_hand(), 20);
  for (const double zoom : {1.15, 1.2}) {
    const auto thesis = make_adaptive_hann_path({}, {zoom, zoom}, std::nullopt);
    EXPECT_LT(shake(bounded(real, std::nullopt, {zoom, zoom})),
              0.7 * shake(views_of(*thesis, real)))
        << zoom;
  }
}

TEST(BoundedPath, LittleLatencyCostsAtMostTwice) {
  const auto real = clip(walking_hand(), 20);
  const double best = shake(bounded(real, std::nullopt));
  EXPECT_LT(shake(bounded(real, 15)), 1.5 * best);
  EXPECT_LT(shake(bounded(real, 5)), 2 * best);
}

TEST(BoundedPath, IsAsSteadyAtAnyRate) {
  const double usual = shake(bounded(clip(walking_hand(), 10), std::nullopt));
  for (const double fps : {60.0, 120.0}) {
    EXPECT_NEAR(shake(bounded(clip(walking_hand(), 10, fps), std::nullopt)), usual, 0.1 * usual)
        << fps;
  }
  const double soon = shake(bounded(clip(walking_hand(), 10), 6));
  for (const double fps : {60.0, 120.0}) {
    const auto as_late = static_cast<std::size_t>(6 * fps / kFps);
    EXPECT_LT(shake(bounded(clip(walking_hand(), 10, fps), as_late)), 1.15 * soon) << fps;
  }
}

TEST(BoundedPath, FutureDoesNoHarmWhereTheRoomIsFarTooSmall) {
  const auto real = clip(running_hand(), 15);
  const double soon = shake(bounded(real, 5));
  EXPECT_LT(soon, 0.8 * rms_rate_above_rad_s(real, 1));
  EXPECT_LT(shake(bounded(real, std::nullopt)), 1.05 * soon);
}

/// Breathes and trembles, a third of a degree to either side.
std::vector<FramePose> standing_hand() {
  HandModel hand;
  hand.rotation_rad = {{0.1, 0.5, 0.2 * kDegree * Vector3d::Ones()},
                       {0.8, 2, 0.1 * kDegree * Vector3d::Ones()},
                       {6, 12, 0.02 * kDegree * Vector3d::Ones()}};
  return clip(hand, 15);
}

TEST_P(BoundedPathThatLooksAhead, AHandThatMeansToStandIsNailed) {
  const auto real = standing_hand();
  ASSERT_GT(rms_rate_above_rad_s(real, 0.3), 1 * kDegree);
  EXPECT_LT(rms_rate_above_rad_s(poses_of(bounded(real, GetParam())), 0.3), 0.15 * kDegree);
}

/// Turns by 60 degrees within a second, 3 s after it began to stand.
double step_pan_rad(double t_s) {
  const double part = std::clamp(t_s - 3, 0.0, 1.0);
  return 60 * kDegree * part;
}

double smooth_pan_rad(double t_s) {
  const double part = std::clamp(t_s - 3, 0.0, 1.0);
  return 60 * kDegree * (1 - std::cos(std::numbers::pi * part)) / 2;
}

TEST_P(BoundedPathThatLooksAhead, APanEndsSoonAndWithoutOvershoot) {
  for (const auto& pan : {step_pan_rad, smooth_pan_rad}) {
    for (const double zoom : {1.1, 1.15, 1.25}) {
      for (const SteadyView& view : bounded(yawing(240, pan), GetParam(), {zoom, zoom})) {
        const double yaw_deg = yaw_of(view.steady) / kDegree;
        EXPECT_GT(yaw_deg, -1);
        EXPECT_LT(yaw_deg, 61);
        constexpr std::int64_t kSettled = 135;  // half a second after its end
        if (view.steady.stamp.index > kSettled) {
          EXPECT_GT(yaw_deg, 59) << view.steady.stamp.index;
        }
      }
    }
  }
}

TEST_P(BoundedPathOfLatency, AnAutomaticZoomKeepsToItsLimitsAndItsSpeed) {
  for (const ZoomChoice zoom : {ZoomChoice{1.05, 1.12, 0.08}, ZoomChoice{1, 1.5, 0.02}}) {
    for (const HandModel& hand : {walking_hand(), running_hand(), panning_hand()}) {
      const auto real = clip(hand, 6);
      const auto views = bounded(real, GetParam(), zoom);
      ASSERT_EQ(views.size(), real.size());
      for (std::size_t i = 0; i < views.size(); ++i) {
        EXPECT_GE(views[i].zoom, zoom.least) << i;
        EXPECT_LE(views[i].zoom, zoom.most) << i;
        if (i == 0) continue;
        const double passed_s = to_seconds(real[i].stamp.time - real[i - 1].stamp.time);
        EXPECT_LE(views[i].zoom - views[i - 1].zoom, zoom.speed_per_s * passed_s + 1e-9) << i;
        EXPECT_GE(views[i].zoom - views[i - 1].zoom, -zoom.speed_per_s * passed_s - 1e-9) << i;
      }
    }
  }
}

/// Walks, and holds the camera ever differently tilted.
std::vector<FramePose> rolling_walk() {
  HandModel hand = walking_hand();
  hand.rotation_rad.push_back({0.05, 0.3, Vector3d(0, 0, 4 * kDegree)});
  return clip(hand, 20);
}

double worst_roll_deg(const std::vector<SteadyView>& views) {
  double worst = 0;
  for (const SteadyView& view : views) {
    worst = std::max(worst, std::abs(roll_rad(view.steady.q_world_camera)) / kDegree);
  }
  return worst;
}

std::vector<SteadyView> with_horizon(Horizon horizon, const std::vector<FramePose>& real,
                                     PathLatency latency, ZoomChoice zoom) {
  BoundedPath path({1, {horizon, 45 * kDegree}}, zoom, latency);
  return views_of(path, real);
}

TEST_P(BoundedPathThatLooksAhead, AHardHorizonIsLevelWhereTheFrameReaches) {
  const auto real = rolling_walk();
  double rolled_deg = 0;
  for (const FramePose& pose : real) {
    rolled_deg = std::max(rolled_deg, std::abs(roll_rad(pose.q_world_camera)) / kDegree);
  }
  ASSERT_GT(rolled_deg, 8);
  EXPECT_LT(worst_roll_deg(with_horizon(Horizon::hard, real, GetParam(), {1.6, 1.6})), 0.1);
  // The zoom that it takes comes no faster than an eye bears.
  const double breathing = worst_roll_deg(with_horizon(Horizon::hard, real, GetParam(), {1, 1.7}));
  EXPECT_LT(breathing, GetParam() == PathLatency{5} ? 1.5 : 0.7);
}

TEST_P(BoundedPathThatLooksAhead, AHardHorizonGivesWayToTheFramesEdgeSteadily) {
  const auto real = rolling_walk();
  const auto views = with_horizon(Horizon::hard, real, GetParam(), {1.15, 1.15});
  for (std::size_t i = 0; i < views.size(); ++i) {
    EXPECT_LE(frame_of(real[i]).required_zoom(views[i].steady.q_world_camera), 1.15) << i;
  }
  EXPECT_LT(shake(views), 0.8 * rms_rate_above_rad_s(real, 1));
}

TEST_P(BoundedPathThatLooksAhead, ASoftHorizonIsLeveller) {
  const auto real = rolling_walk();
  const auto mean_roll = [](const std::vector<SteadyView>& views) {
    double sum = 0;
    for (const SteadyView& view : views) sum += std::abs(roll_rad(view.steady.q_world_camera));
    return sum / static_cast<double>(views.size());
  };
  const ZoomChoice zoom{1.3, 1.3};
  const auto soft = with_horizon(Horizon::soft, real, GetParam(), zoom);
  EXPECT_LT(mean_roll(soft), 0.5 * mean_roll(bounded(real, GetParam(), zoom)));
  for (std::size_t i = 0; i < soft.size(); ++i) {
    EXPECT_LE(frame_of(real[i]).required_zoom(soft[i].steady.q_world_camera), zoom.most) << i;
  }
}

TEST_P(BoundedPathOfLatency, ACameraThatTurnsRoundAndRoundIsFollowed) {
  const auto real = yawing(300, [](double t_s) { return 2.5 * t_s + 0.02 * std::sin(12 * t_s); });
  const auto views = bounded(real, GetParam());
  // A view that knows nothing of what is to come starts from rest.
  const auto later = [](std::vector<FramePose> poses) {
    poses.erase(poses.begin(), poses.begin() + 60);
    return poses;
  };
  EXPECT_LT(rms_rate_above_rad_s(later(poses_of(views)), 1),
            0.3 * rms_rate_above_rad_s(later(real), 1));
}

TEST_P(BoundedPathThatLooksAhead, BeginsAtTheCamerasPace) {
  const auto real = yawing(90, [](double t_s) { return 0.5 * t_s; });
  const auto views = bounded(real, GetParam());
  EXPECT_LT(shake(views), 0.045);  // from rest .053 to .065
}

TEST_P(BoundedPathOfLatency, FramesThatAreMissingDoNoHarm) {
  auto real = clip(walking_hand(), 10);
  for (std::size_t i = real.size(); i-- > 0;) {
    if (i % 10 == 3 || (i > 150 && i < 160)) {
      real.erase(real.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  EXPECT_LT(shake(bounded(real, GetParam())), 0.5 * rms_rate_above_rad_s(real, 1));
}

TEST_P(BoundedPathOfLatency, AutomaticZoomStaysWithinItsLimitsAndSuffices) {
  const auto real = clip(walking_hand(), 20);
  double most = 0;
  const auto views = bounded(real, GetParam(), {1, 1.25});
  for (std::size_t i = 0; i < views.size(); ++i) {
    most = std::max(most, views[i].zoom);
    EXPECT_GE(views[i].zoom, 1);
    EXPECT_LE(views[i].zoom, 1.25);
    EXPECT_LE(frame_of(real[i]).required_zoom(views[i].steady.q_world_camera), views[i].zoom);
  }
  EXPECT_GT(most, 1.05);
}

}  // namespace
}  // namespace gimbal
