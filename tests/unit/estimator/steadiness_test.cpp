#include "pipeline/estimator/steadiness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace gimbal {
namespace {

constexpr double kInterval_s = 0.02;

double density_of(double duration_s, const std::function<Eigen::Vector3d(double)>& mean_rate) {
  Steadiness steadiness{SteadinessParameters{}};
  for (double t = 0; t < duration_s; t += kInterval_s) {
    steadiness.add(kInterval_s * mean_rate(t), kInterval_s);
  }
  return steadiness.rate_density_rad2_s();
}

TEST(Steadiness, IsTheDensityOfAWhiteNoise) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const double density_rad2_s = 1e-4;
  const double sigma = std::sqrt(density_rad2_s / kInterval_s);
  double sum = 0;
  constexpr int kRuns = 300;
  for (int run = 0; run < kRuns; ++run) {
    sum += density_of(
        10, [&](double) { return Eigen::Vector3d(0.1 + sigma * normal(random), -0.05, 0.3); });
  }
  // Whenever a block is less steady than those before, it counts alone: on average that is more.
  EXPECT_GT(sum / kRuns, density_rad2_s);
  EXPECT_LT(sum / kRuns, 2.5 * density_rad2_s);
}

TEST(Steadiness, VibrationCancelsAndTurnsDoNot) {
  const auto swing = [](double rate_hz) {
    return density_of(10, [=](double t) {
      return Eigen::Vector3d(0, 0.1 * std::sin(2 * std::numbers::pi * rate_hz * t), 0);
    });
  };
  EXPECT_LT(swing(17), 0.1 * swing(1));
  EXPECT_GT(swing(0.3), 1e-5);
}

TEST(Steadiness, SaysNothingOfTheFirstMoments) {
  const auto still = [](double) { return Eigen::Vector3d(0.01, 0, 0); };
  EXPECT_TRUE(std::isinf(density_of(0.7, still)));
  EXPECT_LT(density_of(1, still), 1e-12);
}

TEST(Steadiness, AJoltCountsAtOnceAndIsForgotten) {
  const auto jolt_before_s = [](double age_s) {
    return density_of(10, [=](double t) {
      return Eigen::Vector3d(t > 10 - age_s && t < 10 - age_s + 0.3 ? 0.5 : 0, 0, 0);
    });
  };
  EXPECT_GT(jolt_before_s(0.6), 0.01);
  EXPECT_LT(jolt_before_s(6), 0.05 * jolt_before_s(0.6));
}

}  // namespace
}  // namespace gimbal
