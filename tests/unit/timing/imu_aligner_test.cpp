#include "pipeline/timing/imu_aligner.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace gimbal {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

SensorTime at_ms(int ms) {
  return SensorTime(milliseconds(ms));
}

/// Changes linearly in time, so that linear interpolation has no error.
Eigen::Vector3d accel_truth(SensorTime time) {
  const double t = seconds_since_epoch(time);
  return {1 + 2 * t, -3 * t, 9.8 + 0.5 * t};
}

GyroSample gyro(SensorTime time) {
  return {time, {seconds_since_epoch(time), 0, 0}};
}
AccelSample accel(SensorTime time) {
  return {time, accel_truth(time)};
}

std::vector<GyroSample> gyro_samples(SensorDuration from, SensorDuration to, SensorDuration step) {
  std::vector<GyroSample> samples;
  for (auto t = from; t <= to; t += step) samples.push_back(gyro(SensorTime(t)));
  return samples;
}

std::vector<AccelSample> accel_samples(SensorDuration from, SensorDuration to,
                                       SensorDuration step) {
  std::vector<AccelSample> samples;
  for (auto t = from; t <= to; t += step) samples.push_back(accel(SensorTime(t)));
  return samples;
}

std::vector<ImuSample> take(ImuAligner& aligner) {
  std::vector<ImuSample> samples;
  while (const auto sample = aligner.pop()) samples.push_back(*sample);
  return samples;
}

std::vector<ImuSample> align_in_order_of_time(const std::vector<GyroSample>& gyros,
                                              const std::vector<AccelSample>& accels) {
  ImuAligner aligner(Accelerometer::present);
  auto next_accel = accels.begin();
  for (const auto& sample : gyros) {
    for (; next_accel != accels.end() && next_accel->time < sample.time; ++next_accel) {
      aligner.push(*next_accel);
    }
    aligner.push(sample);
  }
  for (; next_accel != accels.end(); ++next_accel) aligner.push(*next_accel);
  aligner.finish();
  return take(aligner);
}

TEST(ImuAligner, InterpolatesToTheGyroscopesStamps) {
  const auto samples = align_in_order_of_time(
      gyro_samples(milliseconds(20), milliseconds(900), microseconds(2427)),
      accel_samples(milliseconds(0), milliseconds(1000), microseconds(9973)));
  ASSERT_EQ(samples.size(), 363U);
  for (const auto& sample : samples) {
    EXPECT_EQ(sample.gyro_rad_s.x(), seconds_since_epoch(sample.time));
    ASSERT_TRUE(sample.accel_m_s2);
    EXPECT_LT((*sample.accel_m_s2 - accel_truth(sample.time)).norm(), 1e-12);
  }
}

TEST(ImuAligner, GivesTheSameHoweverTheStreamsAreInterleaved) {
  const auto gyros = gyro_samples(milliseconds(0), milliseconds(3000), milliseconds(10));
  auto accels = accel_samples(milliseconds(33), milliseconds(2500), milliseconds(16));
  accels.erase(accels.begin() + 40, accels.begin() + 60);  // a gap of a third of a second
  const auto expected = align_in_order_of_time(gyros, accels);
  ASSERT_EQ(expected.size(), gyros.size());

  std::mt19937 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    ImuAligner aligner(Accelerometer::present);
    std::vector<ImuSample> samples;
    std::size_t g = 0, a = 0;
    while (g < gyros.size() || a < accels.size()) {
      const bool gyro_left = g < gyros.size();
      const bool accel_left = a < accels.size();
      const SensorDuration lead =
          gyro_left && accel_left ? gyros[g].time - accels[a].time : SensorDuration::zero();
      bool gyro_next = random() % 2 == 0;
      if (!accel_left || lead < -milliseconds(900)) gyro_next = true;
      if (!gyro_left || lead > milliseconds(900)) gyro_next = false;
      gyro_next ? aligner.push(gyros[g++]) : aligner.push(accels[a++]);
      for (const auto& sample : take(aligner)) samples.push_back(sample);
    }
    aligner.finish();
    for (const auto& sample : take(aligner)) samples.push_back(sample);

    ASSERT_EQ(samples.size(), expected.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      EXPECT_EQ(samples[i].time, expected[i].time);
      EXPECT_EQ(samples[i].accel_m_s2, expected[i].accel_m_s2) << i;
    }
  }
}

TEST(ImuAligner, DoesNotInterpolateAcrossAGap) {
  const auto samples =
      align_in_order_of_time(gyro_samples(milliseconds(0), milliseconds(400), milliseconds(10)),
                             {accel(at_ms(0)), accel(at_ms(100)), accel(at_ms(201)),
                              accel(at_ms(210)), accel(at_ms(400))});
  for (const auto& sample : samples) {
    const auto t = sample.time;
    const bool in_gap = (t > at_ms(100) && t < at_ms(201)) || (t > at_ms(210) && t < at_ms(400));
    EXPECT_EQ(sample.accel_m_s2.has_value(), !in_gap) << seconds_since_epoch(t);
  }
}

TEST(ImuAligner, HoldsTheFirstAccelerationBackAsFarAsAGapReaches) {
  const auto samples =
      align_in_order_of_time(gyro_samples(milliseconds(0), milliseconds(300), milliseconds(10)),
                             accel_samples(milliseconds(205), milliseconds(400), milliseconds(10)));
  for (const auto& sample : samples) {
    EXPECT_EQ(sample.accel_m_s2.has_value(), sample.time >= at_ms(105));
    if (sample.accel_m_s2 && sample.time < at_ms(205)) {
      EXPECT_EQ(*sample.accel_m_s2, accel_truth(at_ms(205)));
    }
  }
}

TEST(ImuAligner, GoesOnWithoutOnceTheAccelerometerEnds) {
  const auto samples =
      align_in_order_of_time(gyro_samples(milliseconds(0), milliseconds(2000), milliseconds(10)),
                             accel_samples(milliseconds(0), milliseconds(500), milliseconds(10)));
  ASSERT_EQ(samples.size(), 201U);
  for (const auto& sample : samples) {
    EXPECT_EQ(sample.accel_m_s2.has_value(), sample.time <= at_ms(500));
  }
}

TEST(ImuAligner, DoesNotWaitForAnAccelerometerThatIsNotThere) {
  ImuAligner aligner(Accelerometer::absent);
  aligner.push(gyro(at_ms(0)));
  const auto sample = aligner.pop();
  ASSERT_TRUE(sample);
  EXPECT_FALSE(sample->accel_m_s2);
}

TEST(ImuAligner, WaitsNoLongerThanItsPatience) {
  ImuAligner aligner(Accelerometer::present);
  for (int ms = 0; ms <= 1000; ms += 10) aligner.push(gyro(at_ms(ms)));
  EXPECT_FALSE(aligner.pop());
  aligner.push(gyro(at_ms(1010)));
  EXPECT_EQ(take(aligner).size(), 1U);
  for (int ms = 1020; ms <= 60000; ms += 10) {
    aligner.push(gyro(at_ms(ms)));
    EXPECT_EQ(take(aligner).size(), 1U);  // as many out as in: what is held stays bounded
  }
}

TEST(ImuAligner, RefusesWhatIsNotLaterOrNotFinite) {
  ImuAligner aligner(Accelerometer::present);
  EXPECT_TRUE(aligner.push(gyro(at_ms(10))));
  EXPECT_FALSE(aligner.push(gyro(at_ms(10))));
  EXPECT_FALSE(aligner.push(gyro(at_ms(0))));
  EXPECT_FALSE(
      aligner.push(GyroSample{at_ms(20), {0, std::numeric_limits<double>::quiet_NaN(), 0}}));
  EXPECT_TRUE(aligner.push(accel(at_ms(10))));
  EXPECT_FALSE(aligner.push(accel(at_ms(10))));
  EXPECT_FALSE(
      aligner.push(AccelSample{at_ms(20), {0, 0, std::numeric_limits<double>::infinity()}}));
  EXPECT_EQ(aligner.refused(), 5U);
  aligner.finish();
  EXPECT_EQ(take(aligner).size(), 1U);
}

TEST(ImuAligner, OneStampFarAheadCostsNothingThatFollows) {
  const auto align = [](bool with_wrong_stamps) {
    ImuAligner aligner(Accelerometer::present);
    std::vector<ImuSample> samples;
    for (int ms = 0; ms <= 1000; ms += 10) {
      if (with_wrong_stamps && ms == 500) {
        aligner.push(gyro(at_ms(3'600'000)));
        aligner.push(accel(at_ms(7'200'000)));
      }
      EXPECT_TRUE(aligner.push(gyro(at_ms(ms))));
      EXPECT_TRUE(aligner.push(accel(at_ms(ms))));
    }
    EXPECT_EQ(aligner.refused(), with_wrong_stamps ? 2U : 0U);
    for (const ImuSample& sample : take(aligner)) samples.push_back(sample);
    return samples;
  };
  const auto plain = align(false);
  const auto with_wrong_stamps = align(true);
  ASSERT_EQ(with_wrong_stamps.size(), plain.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_EQ(with_wrong_stamps[i].time, plain[i].time);
    EXPECT_EQ(with_wrong_stamps[i].accel_m_s2, plain[i].accel_m_s2);
  }
}

TEST(ImuAligner, AStampFarAheadIsTakenOnceTheNextBearsItOut) {
  ImuAligner aligner(Accelerometer::absent);
  for (const int ms : {0, 10, 5000, 5010, 9000}) EXPECT_TRUE(aligner.push(gyro(at_ms(ms))));
  aligner.finish();
  EXPECT_EQ(take(aligner).size(), 4U);  // nothing came after the last one
  EXPECT_EQ(aligner.refused(), 1U);
}

}  // namespace
}  // namespace gimbal
