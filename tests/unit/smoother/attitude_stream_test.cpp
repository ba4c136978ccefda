#include "pipeline/smoother/attitude_stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

namespace gimbal {
namespace {

using std::chrono::milliseconds;

constexpr double kDegree = std::numbers::pi / 180;

/// A hand that turns back and forth about a level axis, with the noise without which an axis would
/// pass for stuck; 200 Hz.
std::vector<ImuSample> hand(double duration_s) {
  std::vector<ImuSample> samples;
  for (int i = 0; i * 0.005 < duration_s; ++i) {
    const double t = 0.005 * i;
    const double angle = 0.4 * std::sin(3 * t);
    const Eigen::Vector3d up(0, std::sin(angle), std::cos(angle));
    const double noise = 0.001 * std::sin(700.0 * i);
    samples.push_back({SensorTime(milliseconds(5 * i)),
                       {1.2 * std::cos(3 * t), 0.01 + noise, -0.02 + noise},
                       Eigen::Vector3d(kGravity_m_s2 * up + Eigen::Vector3d(noise, 0, 0))});
  }
  return samples;
}

std::vector<AttitudeEstimate> through(AttitudeStream& stream,
                                      const std::vector<ImuSample>& samples) {
  std::vector<AttitudeEstimate> answers;
  const auto take = [&] {
    while (const auto answer = stream.pop()) answers.push_back(*answer);
  };
  for (const ImuSample& sample : samples) {
    stream.push(sample);
    take();
  }
  stream.finish();
  take();
  return answers;
}

std::vector<AttitudeEstimate> causal(const std::vector<ImuSample>& samples) {
  return through(*make_causal_stream(AttitudeEkfParameters{}), samples);
}

std::vector<AttitudeEstimate> smoothed(const std::vector<ImuSample>& samples) {
  return through(*make_smoothed_stream(FixedLagSmootherParameters{}), samples);
}

/// The largest difference between answers for the same instant.
double largest_difference_rad(const std::vector<AttitudeEstimate>& a,
                              const std::vector<AttitudeEstimate>& b) {
  double largest = 0;
  auto other = b.begin();
  for (const AttitudeEstimate& own : a) {
    while (other != b.end() && other->attitude.time < own.attitude.time) ++other;
    if (other == b.end() || other->attitude.time != own.attitude.time) continue;
    largest =
        std::max(largest, own.attitude.q_world_imu.angularDistance(other->attitude.q_world_imu));
  }
  return largest;
}

// The least of these would leave 1 degree.
TEST(AttitudeStream, ASampleOfGarbageLeavesNoMark) {
  const std::vector<ImuSample> clean = hand(10);
  for (const double garbage_rad_s : {4.0, -17.5, 35.0}) {
    std::vector<ImuSample> dirty = clean;
    for (const std::size_t at : {500U, 900U, 1300U}) dirty[at].gyro_rad_s.y() = garbage_rad_s;
    EXPECT_LT(largest_difference_rad(causal(clean), causal(dirty)), 0.1 * kDegree);
    EXPECT_LT(largest_difference_rad(smoothed(clean), smoothed(dirty)), 0.1 * kDegree);
    EXPECT_EQ(causal(dirty).size(), clean.size() - 3);
  }
}

TEST(AttitudeStream, AForceOfGarbageLeavesNoMark) {
  const std::vector<ImuSample> clean = hand(10);
  std::vector<ImuSample> dirty = clean;
  for (const std::size_t at : {500U, 900U, 1300U}) dirty[at].accel_m_s2->x() = 157;
  EXPECT_LT(largest_difference_rad(causal(clean), causal(dirty)), 0.1 * kDegree);
  EXPECT_EQ(causal(dirty).size(), clean.size());
}

TEST(AttitudeStream, AHardStartIsNoSpike) {
  std::vector<ImuSample> samples = hand(6);
  // From one sample to the next it spins at 8 rad/s, for 20 intervals, and stops as suddenly. A
  // value that repeated itself would pass for clipped.
  for (std::size_t i = 1000; i < 1020; ++i) {
    samples[i].gyro_rad_s.z() += i % 2 == 0 ? 7.95 : 8.05;
  }
  const std::vector<AttitudeEstimate> answers = causal(samples);
  const std::vector<AttitudeEstimate> without = causal(hand(6));
  ASSERT_EQ(answers.size(), samples.size());
  EXPECT_NEAR(
      answers[1030].attitude.q_world_imu.angularDistance(without[1030].attitude.q_world_imu),
      20 * 0.005 * 8, 0.5 * kDegree);
}

TEST(AttitudeStream, TellsABiasForTheNextRunOnlyIfItIsToBeTrusted) {
  const std::vector<ImuSample> samples = hand(6);
  std::vector<ImuSample> in_g = samples;
  for (ImuSample& sample : in_g) *sample.accel_m_s2 /= kGravity_m_s2;
  const auto streams = [] {
    std::array<std::unique_ptr<AttitudeStream>, 2> both;
    both[0] = make_causal_stream(AttitudeEkfParameters{});
    both[1] = make_smoothed_stream(FixedLagSmootherParameters{});
    return both;
  };
  for (const auto& stream : streams()) {
    EXPECT_FALSE(stream->gyro_bias());  // nothing seen
    through(*stream, samples);
    ASSERT_TRUE(stream->gyro_bias());
    EXPECT_LT(stream->gyro_bias()->sigma_rad_s.x(),
              AttitudeEkfParameters{}.gyro_bias.sigma_rad_s.x());
  }
  for (const auto& stream : streams()) {
    through(*stream, in_g);
    EXPECT_FALSE(stream->gyro_bias());
  }
}

TEST(AttitudeStream, TheLastSampleIsNotHeldBack) {
  std::vector<ImuSample> samples = hand(2);
  samples.back().gyro_rad_s.z() += 20;
  EXPECT_EQ(causal(samples).size(), samples.size());
  EXPECT_EQ(smoothed(samples).size(), samples.size());
}

}  // namespace
}  // namespace gimbal
