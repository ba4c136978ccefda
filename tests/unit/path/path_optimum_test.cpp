#include "pipeline/path/path_optimum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace gimbal {
namespace {

using Eigen::Vector3d;

constexpr double kInterval_s = 1 / 30.0;
constexpr std::size_t kFrames = 400;

/// A camera that swings about y, or stands where the amplitude is 0.
std::vector<PathTarget> swing(double amplitude_rad, double hz) {
  std::vector<PathTarget> targets(kFrames);
  for (std::size_t i = 0; i < kFrames; ++i) {
    const double t_s = static_cast<double>(i) * kInterval_s;
    targets[i].real_turn_rad = {0, amplitude_rad * std::sin(2 * std::numbers::pi * hz * t_s), 0};
    targets[i].aim = {t_s, targets[i].real_turn_rad};
  }
  return targets;
}

std::array<PathPoint, 3> at_rest() {
  std::array<PathPoint, 3> past;
  for (std::size_t i = 0; i < past.size(); ++i) {
    past[i].time_s = (static_cast<double>(i) - 3) * kInterval_s;
  }
  return past;
}

std::vector<Vector3d> best_views(const PathCost& cost, const std::vector<PathTarget>& targets) {
  std::vector<Vector3d> views;
  for (const PathTarget& target : targets) views.push_back(target.real_turn_rad);
  // From so far away it takes more steps than a frame is given.
  PathOptimum optimum;
  for (int i = 0; i < 10; ++i) optimum.find(cost, at_rest(), targets, views);
  return views;
}

double largest_in_the_middle(const std::vector<Vector3d>& views) {
  double largest = 0;
  for (std::size_t i = kFrames / 3; i < 2 * kFrames / 3; ++i) {
    largest = std::max(largest, std::abs(views[i].y()));
  }
  return largest;
}

/// Room of so many radians to either side, about y.
void give_room(std::vector<PathTarget>& targets, double room_rad) {
  for (PathTarget& target : targets) {
    target.use_per_rad(0, 1) = 1 / room_rad;
    target.use_per_rad(1, 1) = -1 / room_rad;
  }
}

class LowPass : public ::testing::TestWithParam<double> {};

TEST_P(LowPass, HasTheGainOfTheIntegralItMinimises) {
  PathCost cost;
  cost.smoothing_s = 0.3;
  const double hz = GetParam();
  const double squared = std::pow(cost.smoothing_s * 2 * std::numbers::pi * hz, 2);
  const double gain = std::pow(1 + squared, -3);
  const double amplitude_rad = 0.1;
  const double got = largest_in_the_middle(best_views(cost, swing(amplitude_rad, hz)));
  // Differences between frames stand for derivatives: 4 % at the fastest swing.
  EXPECT_NEAR(got, gain * amplitude_rad, 0.04 * gain * amplitude_rad) << hz << " Hz";
}

INSTANTIATE_TEST_SUITE_P(PathOptimum, LowPass, ::testing::Values(0.1, 0.3, 0.5, 1.0));

TEST(PathOptimum, UnevenIntervalsGiveTheSameCurve) {
  PathCost cost;
  cost.smoothing_s = 0.3;
  const double hz = 0.3;
  std::vector<PathTarget> whole = swing(0.1, hz);
  std::vector<PathTarget> with_gaps;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (i % 5 == 1 || i % 7 == 3) continue;
    with_gaps.push_back(whole[i]);
    kept.push_back(i);
  }
  const auto views = best_views(cost, whole);
  const auto gappy = best_views(cost, with_gaps);
  for (std::size_t j = gappy.size() / 3; j < 2 * gappy.size() / 3; ++j) {
    EXPECT_NEAR(gappy[j].y(), views[kept[j]].y(), 2e-3) << kept[j];
  }
}

TEST(PathOptimum, IsFoundFromWherever) {
  PathCost cost;
  cost.walls = {PathWall{0.5, 30}, PathWall{0.95, 1e7}};
  std::vector<PathTarget> targets = swing(0.1, 0.8);
  give_room(targets, 0.06);
  const auto views = best_views(cost, targets);
  std::vector<Vector3d> from_rest(targets.size(), Vector3d::Zero());
  PathOptimum optimum;
  for (int i = 0; i < 10; ++i) optimum.find(cost, at_rest(), targets, from_rest);
  double farthest = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    farthest = std::max(farthest, (from_rest[i] - views[i]).norm());
  }
  EXPECT_LT(farthest, 1e-4);
}

TEST(PathOptimum, StaysInsideOfTheRoomAsSteadilyAsThatAllows) {
  PathCost cost;
  cost.walls = {PathWall{0.5, 30}, PathWall{0.95, 1e7}};
  const double amplitude_rad = 0.1;
  const double room_rad = 0.06;
  std::vector<PathTarget> targets = swing(amplitude_rad, 0.8);
  give_room(targets, room_rad);
  const auto views = best_views(cost, targets);
  for (std::size_t i = 0; i < views.size(); ++i) {
    EXPECT_LT(std::abs(views[i].y() - targets[i].real_turn_rad.y()), 0.97 * room_rad) << i;
  }
  // What is left of the swing is what the room does not take: all of it would be .1 rad.
  EXPECT_LT(largest_in_the_middle(views), 1.1 * (amplitude_rad - 0.95 * room_rad));
}

TEST(PathOptimum, AnAxisCanBeHeldWhileTheOthersAreSmoothed) {
  std::vector<PathTarget> targets = swing(0.1, 1);
  for (PathTarget& target : targets) {
    target.aim.turn_rad.z() = target.aim.turn_rad.y();
    target.axis = Vector3d::UnitZ();
    target.axis_pull = 1e9;
  }
  const auto views = best_views({}, targets);
  for (std::size_t i = 0; i < views.size(); ++i) {
    EXPECT_NEAR(views[i].z(), targets[i].aim.turn_rad.z(), 2e-3) << i;
  }
  EXPECT_LT(largest_in_the_middle(views), 0.01);
}

TEST(PathOptimum, DoesNotOvershoot) {
  PathCost cost;
  cost.overshoot_weight = 1e5;
  std::vector<PathTarget> targets = swing(0, 1);
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (i >= kFrames / 2) targets[i].aim.turn_rad.y() = 1;
    targets[i].least_rad = Vector3d::Zero();
    targets[i].most_rad = Vector3d(0, 1, 0);
  }
  const auto views = best_views(cost, targets);
  for (std::size_t i = 0; i < views.size(); ++i) {
    EXPECT_GT(views[i].y(), -5e-3) << i;
    EXPECT_LT(views[i].y(), 1 + 5e-3) << i;
  }
}

}  // namespace
}  // namespace gimbal
