#include "pipeline/path/rate_prediction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace gimbal {
namespace {

using Eigen::Vector3d;

constexpr double kInterval_s = 1 / 30.0;

/// A walk's swing and its steps, at frequencies that no window holds whole.
Vector3d walking_rad_s(int frame, double interval_s = kInterval_s) {
  const double phase = 2 * std::numbers::pi * frame * interval_s;
  return {0.3 * std::sin(0.93 * phase), 0.4 * std::sin(1.87 * phase + 1), 0};
}

TEST(RatePrediction, SaysNothingBeforeItHasSeenAnything) {
  const RatePrediction prediction;
  for (const Vector3d& rate : prediction.next(10, kInterval_s)) EXPECT_EQ(rate, Vector3d::Zero());
}

TEST(RatePrediction, KnowsTheNextHalfSecondOfAWalk) {
  RatePrediction prediction;
  constexpr int kSeen = 300;
  for (int i = 0; i < kSeen; ++i) prediction.push(walking_rad_s(i), kInterval_s);
  const auto rates = prediction.next(15, kInterval_s);
  ASSERT_EQ(rates.size(), 15U);
  for (int i = 0; i < 15; ++i) {
    EXPECT_LT((rates[static_cast<std::size_t>(i)] - walking_rad_s(kSeen + i)).norm(), 0.05) << i;
  }
}

TEST(RatePrediction, SeesAsFarBackAtAnyRate) {
  for (const int fps : {25, 50, 60, 100, 120, 240}) {
    RatePrediction prediction;
    const double interval_s = 1.0 / fps;
    const int seen = 10 * fps + 1;  // in the middle of a step
    for (int i = 0; i < seen; ++i) prediction.push(walking_rad_s(i, interval_s), interval_s);
    Vector3d off_rad = Vector3d::Zero();
    const auto rates = prediction.next(static_cast<std::size_t>(fps / 2), interval_s);
    for (std::size_t i = 0; i < rates.size(); ++i) {
      off_rad += interval_s * (rates[i] - walking_rad_s(seen + static_cast<int>(i), interval_s));
      EXPECT_LT(off_rad.norm(), 0.012) << fps << ' ' << i;  // of .08 rad that such a swing is wide
    }
  }
}

TEST(RatePrediction, ExpectsLittleOfWhatDoesNotRepeat) {
  RatePrediction prediction;
  std::mt19937 random(3);
  std::normal_distribution<double> rate_rad_s(0, 1);
  for (int i = 0; i < 600; ++i) {
    const double x = rate_rad_s(random);
    const double y = rate_rad_s(random);
    const double z = rate_rad_s(random);
    prediction.push({x, y, z}, kInterval_s);
  }
  double sum = 0;
  const auto rates = prediction.next(30, kInterval_s);
  for (const Vector3d& rate : rates) sum += rate.squaredNorm() / 3;
  EXPECT_LT(std::sqrt(sum / static_cast<double>(rates.size())), 0.4);
}

TEST(RatePrediction, DoesNotRunAway) {
  RatePrediction prediction;
  for (int i = 0; i < 200; ++i) {
    prediction.push(Vector3d(0.01 * std::exp(0.03 * i), 0, 0), kInterval_s);
  }
  const double last = 0.01 * std::exp(0.03 * 199);
  for (const Vector3d& rate : prediction.next(200, kInterval_s))
    EXPECT_LE(std::abs(rate.x()), 3.01 * last);
}

}  // namespace
}  // namespace gimbal
