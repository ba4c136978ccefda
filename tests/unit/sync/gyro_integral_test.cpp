#include "pipeline/sync/gyro_integral.hpp"

#include <gtest/gtest.h>

#include "drivers/synthetic/hand_motion.hpp"
#include "drivers/synthetic/motion.hpp"
#include "pipeline/sample/rotation.hpp"

namespace gimbal {
namespace {

const SensorTime kZero = SensorTime(std::chrono::seconds(0));

std::vector<GyroSample> sampled(const Motion& motion, double rate_hz, double duration_s) {
  std::vector<GyroSample> samples;
  for (int i = 0; i < rate_hz * duration_s; ++i) {
    const SensorTime time = time_from_seconds(i / rate_hz);
    samples.push_back({time, motion.at(time).rate_rad_s});
  }
  return samples;
}

/// Largest angle by which a turn over 33 ms is wrong, against the motion that was sampled.
double worst_turn_error_rad(double rate_hz) {
  const Motion motion = make_hand_motion(running_hand(), std::chrono::seconds(10), 5);
  const GyroIntegral gyro(sampled(motion, rate_hz, 10), kZero, Eigen::Vector3d::Zero());
  double worst = 0;
  for (double from_s = 0.05; from_s < 9.9; from_s += 0.0137) {
    const double to_s = from_s + 0.033;
    const auto q_world_camera = [&](double time_s) {
      return motion.at(time_from_seconds(time_s)).q_world_camera;
    };
    const Eigen::Quaterniond truth = q_world_camera(from_s).conjugate() * q_world_camera(to_s);
    const Eigen::Quaterniond felt =
        gyro.at(from_s)->q_start_imu.conjugate() * gyro.at(to_s)->q_start_imu;
    worst = std::max(worst, truth.angularDistance(felt));
  }
  return worst;
}

// A tenth of a pixel is 8e-5 rad at a focal length of 1200 px.
TEST(GyroIntegral, FollowsARunningHandBetweenItsSamples) {
  EXPECT_LT(worst_turn_error_rad(400), 2e-6);
  EXPECT_LT(worst_turn_error_rad(100), 8e-5);
}

TEST(GyroIntegral, TellsHowTheOrientationDependsOnTheBias) {
  const Motion motion = make_hand_motion(walking_hand(), std::chrono::seconds(3), 2);
  const auto samples = sampled(motion, 200, 3);
  const Eigen::Vector3d step(1e-5, -2e-5, 3e-5);
  const GyroState without = *GyroIntegral(samples, kZero, Eigen::Vector3d::Zero()).at(2.34567);
  const GyroState with = *GyroIntegral(samples, kZero, step).at(2.34567);
  const Eigen::Vector3d turned = quaternion_log(with.q_start_imu * without.q_start_imu.conjugate());
  EXPECT_LT((turned + without.bias_lever_s * step).norm(), 0.002 * turned.norm());
}

TEST(GyroIntegral, KnowsNothingOutsideTheLogAndAcrossGaps) {
  std::vector<GyroSample> samples;
  for (int i = 0; i < 300; ++i) {
    if (i >= 100 && i < 150) continue;
    samples.push_back({time_from_seconds(0.01 * i), Eigen::Vector3d::Zero()});
  }
  const GyroIntegral gyro(samples, kZero, Eigen::Vector3d::Zero());
  EXPECT_FALSE(gyro.at(-0.001));
  EXPECT_FALSE(gyro.at(2.991));
  EXPECT_TRUE(gyro.covers(0.1, 0.9));
  EXPECT_TRUE(gyro.covers(1.6, 2.9));
  EXPECT_FALSE(gyro.covers(0.9, 1.6));
  EXPECT_FALSE(gyro.covers(0.9, 1.2));
  EXPECT_FALSE(gyro.covers(1.2, 1.6));
  EXPECT_FALSE(gyro.covers(2.9, 3.1));
}

}  // namespace
}  // namespace gimbal
