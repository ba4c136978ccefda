#include "pipeline/calibration/gyro_noise.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "drivers/synthetic/hand_motion.hpp"
#include "drivers/synthetic/random.hpp"
#include "drivers/synthetic/synthetic_imu.hpp"

namespace gimbal {
namespace {

const Eigen::Vector3d kBias(0.01, -0.02, 0.004);
constexpr double kDensity = 2e-4;  // one-sided, as data sheets have it

std::vector<GyroSample> gyro_of(const HandModel& hand, SensorDuration duration, double rate_hz,
                                std::uint64_t seed) {
  SyntheticImuSettings settings;
  settings.span = {SensorTime(SensorDuration::zero()), SensorTime(duration)};
  settings.gyro_clock.rate_hz = rate_hz;
  settings.gyro.noise_density = kDensity;
  settings.gyro.bias = kBias;
  settings.seed = seed;
  return (*SyntheticImu::create(settings, make_hand_motion(hand, duration, seed)))->gyro();
}

// The mean over T of noise with a one-sided density of n²: n² / (2 T).
TEST(GyroNoise, OfAStillMinuteIsThatOfTheSensor) {
  for (const double rate_hz : {100.0, 400.0}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const GyroNoise noise =
          measure_gyro_noise(gyro_of(tripod(), std::chrono::seconds(60), rate_hz, seed));
      ASSERT_EQ(noise.reason, "");
      for (int axis = 0; axis < 3; ++axis) {
        const double density = kDensity / std::sqrt(2);
        EXPECT_NEAR(noise.noise_rad_s_rthz[axis], density, 0.1 * density);
        EXPECT_LT(std::abs(noise.bias_rad_s[axis] - kBias[axis]), 4 * noise.bias_sigma_rad_s[axis]);
        EXPECT_NEAR(noise.bias_sigma_rad_s[axis], density / std::sqrt(60), 3e-6);
      }
    }
  }
}

TEST(GyroNoise, BoundsHowFarTheBiasWalks) {
  constexpr double kWalk = 1e-3;  // rad/s a root of a second
  auto samples = gyro_of(tripod(), std::chrono::seconds(120), 100, 4);
  Random random(5);
  Eigen::Vector3d walked = Eigen::Vector3d::Zero();
  for (GyroSample& sample : samples) {
    walked += kWalk * std::sqrt(0.01) *
              Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    sample.gyro_rad_s += walked;
  }
  const GyroNoise noise = measure_gyro_noise(samples);
  ASSERT_EQ(noise.reason, "");
  for (const double walk : noise.most_bias_walk) {
    EXPECT_GT(walk, 0.5 * kWalk);
    EXPECT_LT(walk, 1.5 * kWalk);
  }
}

TEST(GyroNoise, CannotBeToldOfAHandOrOfAMoment) {
  EXPECT_THAT(measure_gyro_noise(gyro_of(walking_hand(), std::chrono::seconds(60), 100, 1)).reason,
              ::testing::HasSubstr("lies still for"));
  EXPECT_THAT(measure_gyro_noise(gyro_of(tripod(), std::chrono::seconds(20), 100, 1)).reason,
              ::testing::HasSubstr("lies still for"));
  EXPECT_NE(measure_gyro_noise({}).reason, "");
}

TEST(GyroNoise, LeavesOutAPush) {
  auto samples = gyro_of(tripod(), std::chrono::seconds(60), 100, 1);
  for (std::size_t i = 500; i < 560; ++i) samples[i].gyro_rad_s.x() += 0.1;
  const GyroNoise noise = measure_gyro_noise(samples);
  EXPECT_EQ(noise.reason, "");
  EXPECT_NEAR(noise.still_s, 54.4, 0.3);
  EXPECT_NEAR(noise.bias_rad_s.x(), kBias.x(), 1e-4);
}

}  // namespace
}  // namespace gimbal
