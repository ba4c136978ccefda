#include "pipeline/path/adaptive_window.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "pipeline/path/pose_filter.hpp"

namespace gimbal {
namespace {

using std::numbers::pi;

FramePose pose_at(std::size_t index, double fps, const Eigen::Quaterniond& q_world_camera) {
  const auto i = static_cast<std::int64_t>(index);
  return {{i, time_from_seconds(static_cast<double>(i) / fps), {}}, q_world_camera};
}

/// A hand's tremor: seeded, all axes, 1 to 8 Hz, about 0.1 rad/s rms together.
Eigen::Quaterniond tremor(double seconds) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> phase(0, 2 * pi);
  std::uniform_real_distribution<double> hertz(1, 8);
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();
  for (int i = 0; i < 12; ++i) {
    const double rate = 2 * pi * hertz(random);
    turn_rad(i % 3) += 0.04 / rate * std::sin(rate * seconds + phase(random));
  }
  return Eigen::Quaterniond(Eigen::AngleAxisd(turn_rad.norm(), turn_rad.normalized()));
}

struct Pan {
  double from_s;
  double to_s;
  double rate_rad_s;
};

/// Tremor, and about the y axis the pan.
std::vector<FramePose> handheld(double seconds, double fps, const Pan& pan) {
  std::vector<FramePose> poses;
  for (std::size_t i = 0; static_cast<double>(i) < seconds * fps; ++i) {
    const double t = static_cast<double>(i) / fps;
    const double turn_rad = pan.rate_rad_s * (std::clamp(t, pan.from_s, pan.to_s) - pan.from_s);
    poses.push_back(
        pose_at(i, fps, Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitY()) * tremor(t)));
  }
  return poses;
}

constexpr Pan kNoPan{0, 0, 0};
constexpr Pan kPan{5, 7, 60 * pi / 180};

/// Window N of each frame when `latency` frames of future are known.
std::vector<int> windows(const std::vector<FramePose>& poses, std::size_t latency,
                         const AdaptiveHannParameters& parameters = {}) {
  AdaptiveWindow window(parameters);
  std::vector<int> sizes;
  for (std::size_t pushed = 0; pushed < poses.size(); ++pushed) {
    window.push(poses[pushed]);
    if (pushed < latency) continue;
    sizes.push_back(1 + 2 * static_cast<int>(window.half_width(pushed - latency)));
  }
  return sizes;
}

TEST(AdaptiveWindow, StaysWideForAHandsTremor) {
  const auto sizes = windows(handheld(20, 30, kNoPan), 49);
  EXPECT_EQ(*std::ranges::min_element(sizes), 99);
}

TEST(AdaptiveWindow, StaysWideForASlowPan) {
  const auto sizes = windows(handheld(20, 30, {5, 15, 10 * pi / 180}), 49);
  EXPECT_EQ(*std::ranges::min_element(sizes), 99);
}

/// The gyroscope of the log, integrated and looked up at `fps`.
std::vector<FramePose> real_motion(double from_s, double to_s, double fps) {
  std::ifstream file(std::string(GIMBALD_SHARED) + "/data/logs/iphone-handheld/gyro.csv");
  std::vector<FramePose> poses;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  double last = -1;
  for (std::string line; std::getline(file, line);) {
    double t = 0, x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &t, &x, &y, &z) != 4) continue;
    if (last >= 0) {
      const Eigen::Vector3d turn_rad = Eigen::Vector3d(x, y, z) * (t - last);
      q = q * Eigen::Quaterniond(Eigen::AngleAxisd(turn_rad.norm(), turn_rad.stableNormalized()));
    }
    last = t;
    if (t < from_s || t > to_s) continue;
    if (t - from_s < static_cast<double>(poses.size()) / fps) continue;
    poses.push_back(pose_at(poses.size(), fps, q));
  }
  return poses;
}

TEST(AdaptiveWindow, StaysWideForARealHandThatHoldsStill) {
  // From 3.1 s on the log's camera turns back and forth at 1 rad/s.
  const auto poses = real_motion(0.1, 3.1, 30);
  if (poses.empty()) GTEST_SKIP() << "needs data/logs/iphone-handheld of the shared recordings";
  const auto sizes = windows(poses, 5);
  ASSERT_GT(sizes.size(), 80U);
  EXPECT_EQ(*std::ranges::min_element(sizes), 99);
}

TEST(AdaptiveWindow, NarrowsForTheRealHandsFastTurns) {
  const auto poses = real_motion(24, 32, 30);
  if (poses.empty()) GTEST_SKIP() << "needs data/logs/iphone-handheld of the shared recordings";
  const auto sizes = windows(poses, 49);
  EXPECT_EQ(*std::ranges::min_element(sizes), 29);
}

TEST(AdaptiveWindow, IsNarrowThroughoutAPanAndWideFarFromIt) {
  const auto sizes = windows(handheld(12, 30, kPan), 49);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double t = static_cast<double>(i) / 30;
    if (t >= kPan.from_s + 0.1 && t <= kPan.to_s) {
      EXPECT_EQ(sizes[i], 29) << t;
    }
    if (t < kPan.from_s - 1.5 || t > kPan.to_s + 2) {
      EXPECT_EQ(sizes[i], 99) << t;
    }
  }
}

TEST(AdaptiveWindow, SlidesByOneFrameOnEitherSide) {
  for (std::size_t latency : {0U, 5U, 49U}) {
    const auto sizes = windows(handheld(12, 30, kPan), latency);
    EXPECT_EQ(*std::ranges::min_element(sizes), 29);
    EXPECT_EQ(*std::ranges::max_element(sizes), 99);
    for (std::size_t i = 1; i < sizes.size(); ++i) EXPECT_LE(std::abs(sizes[i] - sizes[i - 1]), 2);
  }
}

TEST(AdaptiveWindow, BeginsToSlideBeforeThePanOnlyIfItKnowsTheFuture) {
  const auto poses = handheld(12, 30, kPan);
  const auto pan_frame = static_cast<std::size_t>(kPan.from_s * 30);
  const auto knowing = windows(poses, 49);
  EXPECT_LE(knowing[pan_frame + 1], 31);
  EXPECT_GT(knowing[pan_frame - 40], 95);
  const auto causal = windows(poses, 0);
  EXPECT_EQ(causal[pan_frame], 99);
}

TEST(AdaptiveWindow, DetectsAPanAtTheSameInstantAtAnyFrameRate) {
  // The excess over the held rate adds up to the threshold: 0.1 / (1.05 - 0.35) = 0.14 s.
  const double expected_s = 0.1 / (kPan.rate_rad_s - 0.35);
  for (double fps : {24.0, 30.0, 60.0, 120.0}) {
    const auto sizes = windows(handheld(8, fps, kPan), 0);
    const auto first = std::ranges::find_if(sizes, [](int size) { return size < 99; });
    ASSERT_NE(first, sizes.end());
    const double detected_s = static_cast<double>(first - sizes.begin()) / fps - kPan.from_s;
    EXPECT_NEAR(detected_s, expected_s, 1 / fps + 0.05) << fps;  // tremor moves it a little
  }
}

TEST(AdaptiveWindow, IsTheSameForEveryAxisAndDirection) {
  std::vector<std::vector<int>> sizes;
  for (int axis = 0; axis < 3; ++axis) {
    for (double sign : {1.0, -1.0}) {
      std::vector<FramePose> poses;
      for (std::size_t i = 0; i < 300; ++i) {
        const double turn_rad = sign * std::clamp(0.03 * (static_cast<double>(i) - 150), 0.0, 1.5);
        poses.push_back(pose_at(
            i, 30, Eigen::Quaterniond(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::Unit(axis)))));
      }
      sizes.push_back(windows(poses, 49));
      EXPECT_EQ(*std::ranges::min_element(sizes.back()), 29);
      EXPECT_EQ(sizes.back(), sizes.front());
    }
  }
}

TEST(AdaptiveHannFilter, StaysCloserToAPanThanTheWideWindow) {
  const auto poses = handheld(12, 30, kPan);
  const auto farthest = [&](PoseFilter& path) {
    for (const auto& pose : poses) path.push(pose);
    path.finish();
    double angle_rad = 0;
    for (const auto& pose : poses) {
      angle_rad =
          std::max(angle_rad, path.pop()->q_world_camera.angularDistance(pose.q_world_camera));
    }
    return angle_rad;
  };
  const auto wide = make_hann_filter(99, {});
  const auto adaptive = make_adaptive_hann_filter({}, {});
  // At a corner between rest and a pan at rate r a Hann window of half width h strays by
  // r h (1/4 - 1/π²) = 0.149 r h.
  const double per_frame = 0.149 * kPan.rate_rad_s / 30;
  EXPECT_NEAR(farthest(*wide), per_frame * 49, 0.01);
  EXPECT_NEAR(farthest(*adaptive), per_frame * 14, 0.02);
}

}  // namespace
}  // namespace gimbal
