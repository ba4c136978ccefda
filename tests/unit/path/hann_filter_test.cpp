#include "pipeline/path/hann_filter.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace gimbal {
namespace {

using std::numbers::pi;

Eigen::Quaterniond turn_y(double angle_rad) {
  return {std::cos(angle_rad / 2), 0, std::sin(angle_rad / 2), 0};
}

FramePose pose_at(std::size_t index, const Eigen::Quaterniond& q_world_camera) {
  const auto i = static_cast<std::int64_t>(index);
  return {{i, SensorTime(std::chrono::nanoseconds(i * 1'000'000'000 / 30)), {}}, q_world_camera};
}

/// A seeded random walk of orientations, a few degrees a frame.
std::vector<FramePose> random_walk(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> step_rad(0, 0.03);
  std::vector<FramePose> poses;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  for (std::size_t i = 0; i < count; ++i) {
    poses.push_back(pose_at(i, q));
    q = (q * Eigen::AngleAxisd(step_rad(random), Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(step_rad(random), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(step_rad(random), Eigen::Vector3d::UnitZ()))
            .normalized();
  }
  return poses;
}

std::vector<FramePose> smooth(PoseFilter& path, const std::vector<FramePose>& poses) {
  std::vector<FramePose> smoothed;
  const auto take = [&] {
    while (const auto pose = path.pop()) smoothed.push_back(*pose);
  };
  for (const auto& pose : poses) {
    path.push(pose);
    take();
  }
  path.finish();
  take();
  return smoothed;
}

std::vector<FramePose> smooth(int window, PathLatency latency,
                              const std::vector<FramePose>& poses) {
  const auto path = make_hann_filter(window, latency);
  return smooth(*path, poses);
}

double angle_between(const FramePose& a, const FramePose& b) {
  return a.q_world_camera.angularDistance(b.q_world_camera);
}

TEST(HannFilter, IsTheWeightedMeanOfTheThesis) {
  // (2.33) and (2.34) written out, in the middle of the clip where the window is whole.
  const auto poses = random_walk(120, 1);
  constexpr int kWindow = 21;
  const auto smoothed = smooth(kWindow, {}, poses);
  ASSERT_EQ(smoothed.size(), poses.size());
  for (int i = 10; i < 110; ++i) {
    double w = 0, x = 0, y = 0, z = 0;
    for (int n = -10; n <= 10; ++n) {
      const double weight = 0.5 * (1 + std::cos(2 * pi * n / (kWindow - 1)));
      const auto& q = poses[static_cast<std::size_t>(i + n)].q_world_camera;
      w += weight * q.w(), x += weight * q.x(), y += weight * q.y(), z += weight * q.z();
    }
    const double norm = std::sqrt(w * w + x * x + y * y + z * z);
    const auto& q = smoothed[static_cast<std::size_t>(i)].q_world_camera;
    EXPECT_NEAR(q.w(), w / norm, 1e-12);
    EXPECT_NEAR(q.x(), x / norm, 1e-12);
    EXPECT_NEAR(q.y(), y / norm, 1e-12);
    EXPECT_NEAR(q.z(), z / norm, 1e-12);
  }
}

TEST(HannFilter, KeepsStampsAndOrder) {
  const auto poses = random_walk(50, 2);
  const auto smoothed = smooth(29, 5, poses);
  ASSERT_EQ(smoothed.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(smoothed[i].stamp.index, poses[i].stamp.index);
    EXPECT_EQ(smoothed[i].stamp.time, poses[i].stamp.time);
  }
}

TEST(HannFilter, OneFrameIsNoSmoothing) {
  const auto poses = random_walk(50, 3);
  const auto smoothed = smooth(1, {}, poses);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT(angle_between(smoothed[i], poses[i]), 1e-12);
  }
}

TEST(HannFilter, LeavesARestingCameraAlone) {
  std::vector<FramePose> poses;
  for (std::size_t i = 0; i < 200; ++i) poses.push_back(pose_at(i, turn_y(1.1)));
  for (const PathLatency latency : {PathLatency{}, PathLatency{0}, PathLatency{5}}) {
    for (const auto& pose : smooth(99, latency, poses)) {
      EXPECT_LT(pose.q_world_camera.angularDistance(turn_y(1.1)), 1e-7);
    }
  }
}

TEST(HannFilter, SignsOfTheInputDoNotMatter) {
  const auto poses = random_walk(200, 4);
  auto flipped = poses;
  std::mt19937 random(5);
  std::bernoulli_distribution coin;
  for (auto& pose : flipped) {
    if (coin(random)) pose.q_world_camera.coeffs() *= -1;
  }
  const auto a = smooth(99, {}, poses);
  const auto b = smooth(99, {}, flipped);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(std::abs(a[i].q_world_camera.dot(b[i].q_world_camera)), 1, 1e-14);
  }
}

TEST(HannFilter, AttenuatesASinusoidByTheHannWindowsResponse) {
  // Response of 0.5 + 0.5 cos(2πn/(N-1)): three Dirichlet kernels.
  constexpr int kWindow = 29;
  constexpr double kAmplitude_rad = 1e-4;  // small: quaternion components are then linear in it
  const auto dirichlet = [](double frequency) {
    return std::sin(kWindow * frequency / 2) / std::sin(frequency / 2);
  };
  const double shift = 2 * pi / (kWindow - 1);
  const double at_rest = 0.5 * kWindow + 0.5 * dirichlet(shift);
  for (double hz : {0.3, 0.7, 1.3, 2.9, 5.0, 8.0}) {
    const double frequency = 2 * pi * hz / 30;
    const double response = (0.5 * dirichlet(frequency) + 0.25 * dirichlet(frequency - shift) +
                             0.25 * dirichlet(frequency + shift)) /
                            at_rest;
    std::vector<FramePose> poses;
    for (std::size_t i = 0; i < 300; ++i) {
      const double phase = frequency * static_cast<double>(i);
      poses.push_back(pose_at(i, turn_y(kAmplitude_rad * std::sin(phase))));
    }
    const auto smoothed = smooth(kWindow, {}, poses);
    for (std::size_t i = 14; i < 286; ++i) {
      const double expected =
          response * kAmplitude_rad * std::sin(frequency * static_cast<double>(i));
      EXPECT_NEAR(2 * smoothed[i].q_world_camera.y(), expected, 1e-6 * kAmplitude_rad) << hz;
    }
  }
}

TEST(HannFilter, FollowsASteadyTurnWithoutLag) {
  std::vector<FramePose> poses;
  for (std::size_t i = 0; i < 300; ++i) {
    poses.push_back(pose_at(i, turn_y(0.02 * static_cast<double>(i))));
  }
  const auto smoothed = smooth(99, {}, poses);  // up to the very ends of the clip
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT(angle_between(smoothed[i], poses[i]), 1e-7) << i;
  }
}

TEST(HannFilter, LagsByTheMeanOfTheTruncatedWindowWhenLatencyIsShort) {
  constexpr double kStep_rad = 1e-4;
  std::vector<FramePose> poses;
  for (std::size_t i = 0; i < 300; ++i) {
    poses.push_back(pose_at(i, turn_y(kStep_rad * static_cast<double>(i))));
  }
  double sum = 0, moment = 0;
  for (int n = -49; n <= 5; ++n) {
    const double weight = 0.5 * (1 + std::cos(2 * pi * n / 98));
    sum += weight, moment += weight * n;
  }
  const auto smoothed = smooth(99, 5, poses);
  const double lag_rad = 2 * smoothed[200].q_world_camera.y() - 200 * kStep_rad;
  EXPECT_NEAR(lag_rad, kStep_rad * moment / sum, 0.01 * kStep_rad);
}

TEST(HannFilter, PoseComesOutExactlyAfterItsLatency) {
  const auto poses = random_walk(100, 6);
  for (std::size_t latency : {0U, 1U, 5U, 60U}) {
    const auto path = make_hann_filter(99, latency);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      path->push(poses[i]);
      const auto out = path->pop();
      ASSERT_EQ(out.has_value(), i >= latency);
      if (out) {
        EXPECT_EQ(out->stamp.index, static_cast<std::int64_t>(i - latency));
      }
      EXPECT_FALSE(path->pop());
    }
    path->finish();
    for (std::size_t i = 0; i < latency; ++i) EXPECT_TRUE(path->pop());
    EXPECT_FALSE(path->pop());
  }
}

TEST(HannFilter, UsesNoPoseLaterThanItsLatency) {
  constexpr std::size_t kChange = 60;
  constexpr std::size_t kLatency = 7;
  const auto poses = random_walk(100, 7);
  auto changed = poses;
  const auto other = random_walk(100, 8);
  for (std::size_t i = kChange; i < 100; ++i) changed[i].q_world_camera = other[i].q_world_camera;

  // Popped late on purpose: what went in meanwhile must not matter.
  const auto all_at_once = [&](const std::vector<FramePose>& input) {
    const auto path = make_adaptive_hann_filter({}, kLatency);
    for (const auto& pose : input) path->push(pose);
    std::vector<FramePose> smoothed;
    while (const auto pose = path->pop()) smoothed.push_back(*pose);
    return smoothed;
  };
  const auto a = all_at_once(poses);
  const auto b = all_at_once(changed);
  for (std::size_t i = 0; i + kLatency < kChange; ++i) {
    EXPECT_EQ(a[i].q_world_camera.coeffs(), b[i].q_world_camera.coeffs()) << i;
  }
  EXPECT_NE(a[kChange].q_world_camera.coeffs(), b[kChange].q_world_camera.coeffs());
}

TEST(HannFilter, HoldsNoMorePosesThanWindowAndLatency) {
  class FixedWindow final : public WindowSize {
   public:
    void push(const FramePose&) override {}
    [[nodiscard]] std::size_t half_width(std::size_t) override { return 49; }
    [[nodiscard]] std::size_t largest_half_width() const override { return 49; }
  };
  for (const PathLatency latency : {PathLatency{}, PathLatency{0}, PathLatency{5}}) {
    HannFilter path(std::make_unique<FixedWindow>(), latency);
    for (std::size_t i = 0; i < 5000; ++i) {
      path.push(pose_at(i, turn_y(0)));
      while (path.pop()) {
      }
      ASSERT_LE(path.held(), 49 + latency.value_or(49) + 1);
    }
  }
}

TEST(HannFilter, TakesClipsShorterThanItsWindow) {
  for (std::size_t count : {0U, 1U, 2U, 3U, 50U}) {
    for (const PathLatency latency : {PathLatency{}, PathLatency{0}, PathLatency{500}}) {
      EXPECT_EQ(smooth(99, latency, random_walk(count, 9)).size(), count);
    }
  }
}

TEST(HannFilter, AFullTurnInsideTheWindowStillGivesAUnitQuaternion) {
  std::vector<FramePose> poses;  // half a turn a frame: neighbours cancel out
  for (std::size_t i = 0; i < 200; ++i) {
    poses.push_back(pose_at(i, turn_y(pi * static_cast<double>(i))));
  }
  for (const auto& pose : smooth(99, {}, poses)) {
    EXPECT_NEAR(pose.q_world_camera.norm(), 1, 1e-9);
  }
}

TEST(HannFilter, AmountSetsTheWindow) {
  EXPECT_EQ(window_for_amount(0), 1);
  EXPECT_EQ(window_for_amount(1), 99);
  EXPECT_EQ(window_for_amount(1, 60), 197);
  EXPECT_EQ(adaptive_hann_for_amount(1).narrow_window, 29);
  int last = 0;
  for (double amount = 0; amount <= 1; amount += 0.01) {
    const int window = window_for_amount(amount);
    EXPECT_EQ(window % 2, 1);
    EXPECT_GE(window, last);
    last = window;
    const auto adaptive = adaptive_hann_for_amount(amount);
    EXPECT_EQ(adaptive.wide_window, window);
    EXPECT_EQ(adaptive.narrow_window % 2, 1);
    EXPECT_LE(adaptive.narrow_window, window);
  }
}

}  // namespace
}  // namespace gimbal
