#include "pipeline/estimator/plausibility.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

namespace gimbal {
namespace {

using std::chrono::milliseconds;

constexpr AxisLosses kNone{};
constexpr AxisLosses kStuck{AxisLoss::none, AxisLoss::stuck, AxisLoss::none};

/// A hand that turns at up to 1 rad/s.
ImuSample in_hand(int i) {
  const double t = 0.005 * i;
  return {SensorTime(milliseconds(5 * i)),
          {std::cos(3 * t), 0.5 * std::sin(2 * t), 0.3},
          Eigen::Vector3d(0.5 * std::sin(7 * t), 0.3, 9.81)};
}

Plausibility verdict_after(double duration_s, const std::function<void(int, ImuSample&)>& spoil) {
  PlausibilityCheck check;
  for (int i = 0; i * 0.005 < duration_s; ++i) {
    ImuSample sample = in_hand(i);
    spoil(i, sample);
    check.update(sample, kNone, kNone);
  }
  return check.verdict();
}

TEST(Plausibility, AFewBadSamplesDecideNothingHoweverLargeTheyAre) {
  EXPECT_EQ(verdict_after(20,
                          [](int i, ImuSample& sample) {
                            if (i % 10 == 3) sample.gyro_rad_s.y() = 1e200;
                            if (i % 10 == 4) *sample.accel_m_s2 *= 1e150;
                            if (i % 10 == 5) sample.accel_m_s2->setZero();
                            if (i % 10 == 6) sample.gyro_rad_s.setConstant(std::nan(""));
                          }),
            Plausibility::plausible);
}

TEST(Plausibility, AWrongUnitIsNamedWithinSecondsDespiteGoodSamples) {
  EXPECT_EQ(verdict_after(4.1,
                          [](int i, ImuSample& sample) {
                            if (i % 10 != 3) sample.gyro_rad_s *= 180 / std::numbers::pi;
                          }),
            Plausibility::gyro_in_degrees);
  EXPECT_EQ(verdict_after(4.1,
                          [](int i, ImuSample& sample) {
                            if (i % 10 != 3) *sample.accel_m_s2 /= kStandardGravity_m_s2;
                          }),
            Plausibility::accel_in_g);
}

// Beyond what the filter takes for a measurement at all.
TEST(Plausibility, RawCountsAreNamed) {
  EXPECT_EQ(verdict_after(4.1, [](int, ImuSample& sample) { sample.gyro_rad_s *= 32768 / 4.363; }),
            Plausibility::gyro_in_degrees);
}

TEST(Plausibility, AUnitFoundWrongStaysWrong) {
  EXPECT_EQ(verdict_after(60,
                          [](int i, ImuSample& sample) {
                            if (i < 1000) *sample.accel_m_s2 /= kStandardGravity_m_s2;
                          }),
            Plausibility::accel_in_g);
}

TEST(Plausibility, AFlightIsPlausible) {
  EXPECT_EQ(verdict_after(60,
                          [](int i, ImuSample& sample) {
                            if (i % 400 < 100) sample.accel_m_s2->setConstant(0.1);  // falls
                            if (i % 400 > 350) sample.gyro_rad_s.x() = 25;           // a roll
                          }),
            Plausibility::plausible);
}

TEST(Plausibility, AHoleIsNoVote) {
  PlausibilityCheck check;
  ImuSample sample = in_hand(0);
  for (int i = 0; i < 10; ++i) {
    sample.time += std::chrono::seconds(10);
    sample.gyro_rad_s.x() = 300;
    check.update(sample, kNone, kNone);
  }
  EXPECT_EQ(check.verdict(), Plausibility::plausible);
}

TEST(Plausibility, AnAxisThatStaysStuckIsNamedAndAShortHitchIsNot) {
  for (const auto& [stuck_samples, gyro, accel] :
       {std::tuple{100, Plausibility::plausible, Plausibility::plausible},
        std::tuple{1000, Plausibility::gyro_stuck, Plausibility::accel_stuck}}) {
    PlausibilityCheck of_gyro;
    PlausibilityCheck of_accel;
    for (int i = 0; i < 2000; ++i) {
      const bool is_stuck = i >= 500 && i < 500 + stuck_samples;
      of_gyro.update(in_hand(i), is_stuck ? kStuck : kNone, kNone);
      of_accel.update(in_hand(i), kNone, is_stuck ? kStuck : kNone);
    }
    EXPECT_EQ(of_gyro.verdict(), gyro);
    EXPECT_EQ(of_accel.verdict(), accel);
  }
}

TEST(Plausibility, EveryOddityHasALine) {
  EXPECT_TRUE(describe(Plausibility::plausible).empty());
  for (const Plausibility odd :
       {Plausibility::gyro_in_degrees, Plausibility::gyro_stuck, Plausibility::accel_in_g,
        Plausibility::accel_too_small, Plausibility::accel_too_large, Plausibility::accel_stuck}) {
    EXPECT_FALSE(describe(odd).empty());
    EXPECT_EQ(describe(odd).find('\n'), std::string_view::npos);
  }
}

}  // namespace
}  // namespace gimbal
