#include "drivers/synthetic/synthetic_imu.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "drivers/synthetic/hand_motion.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const Eigen::Matrix3d kLandscape = (Eigen::Matrix3d() << 0, -1, 0, -1, 0, 0, 0, 0, -1).finished();

SyntheticImuSettings settings_for(SensorDuration duration) {
  SyntheticImuSettings settings;
  settings.R_camera_imu = kLandscape;
  settings.span = {SensorTime(), SensorTime(duration)};
  settings.gyro_clock = {1000.0, {}};
  settings.accel_clock = {100.0, milliseconds(3)};
  return settings;
}

std::unique_ptr<SyntheticImu> make_imu(const SyntheticImuSettings& settings, const Motion& motion) {
  auto imu = SyntheticImu::create(settings, motion);
  EXPECT_TRUE(imu.has_value());
  return std::move(*imu);
}

TEST(SyntheticImu, GyroIntegratesBackToTheTruth) {
  const Motion motion = make_hand_motion(running_hand(), seconds(10), 1);
  const auto imu = make_imu(settings_for(seconds(10)), motion);
  // Trapezoids on SO(3): each step turns by the mean of its ends' rates.
  Eigen::Quaterniond q_world_imu(motion.at(SensorTime()).q_world_camera.toRotationMatrix() *
                                 kLandscape);
  const std::vector<GyroSample>& gyro = imu->gyro();
  for (std::size_t i = 1; i < gyro.size(); ++i) {
    const Eigen::Vector3d turn = 0.5 * (gyro[i - 1].gyro_rad_s + gyro[i].gyro_rad_s) *
                                 to_seconds(gyro[i].time - gyro[i - 1].time);
    q_world_imu = q_world_imu * Eigen::AngleAxisd(turn.norm(), turn.normalized());
  }
  const Eigen::Quaterniond truth(motion.at(gyro.back().time).q_world_camera.toRotationMatrix() *
                                 kLandscape);
  EXPECT_LT(q_world_imu.angularDistance(truth), 2e-4);
}

TEST(SyntheticImu, AccelerometerFeelsGravityInItsOwnAxes) {
  // Level landscape: the camera's y points down, and so does the IMU's -x. Specific force is up.
  const Motion motion = make_hand_motion(tripod(), seconds(1), 1);
  const auto imu = make_imu(settings_for(seconds(1)), motion);
  for (const AccelSample& sample : imu->accel()) {
    EXPECT_LT((sample.accel_m_s2 - Eigen::Vector3d(9.80665, 0, 0)).norm(), 1e-9);
  }
}

TEST(SyntheticImu, SamplesComeInOrderEachAtItsOwnRateAndPhase) {
  const Motion motion = make_hand_motion(tripod(), seconds(1), 1);
  const auto imu = make_imu(settings_for(seconds(1)), motion);
  ASSERT_TRUE(imu->start().has_value());
  SensorTime last = SensorTime::min();
  std::size_t gyro = 0;
  std::size_t accel = 0;
  while (const auto reading = imu->read().value()) {
    const SensorTime time = std::visit([](const auto& sample) { return sample.time; }, *reading);
    EXPECT_GE(time, last);
    last = time;
    if (const auto* sample = std::get_if<AccelSample>(&*reading)) {
      EXPECT_EQ(sample->time, SensorTime(milliseconds(3 + 10 * static_cast<int>(accel++))));
    } else {
      ++gyro;
    }
  }
  EXPECT_EQ(gyro, 1000U);
  EXPECT_EQ(accel, 100U);
}

TEST(SyntheticImu, StartsAgainAndStops) {
  const Motion motion = make_hand_motion(tripod(), seconds(1), 1);
  const auto imu = make_imu(settings_for(seconds(1)), motion);
  ASSERT_TRUE(imu->start().has_value());
  ASSERT_TRUE(imu->read().value().has_value());
  imu->stop();
  EXPECT_FALSE(imu->read().value().has_value());
  ASSERT_TRUE(imu->start().has_value());
  EXPECT_EQ(std::get<GyroSample>(*imu->read().value()).time, SensorTime());
}

TEST(SyntheticImu, NoiseBiasAndScaleAreAsGiven) {
  const Motion motion = make_hand_motion(tripod(), seconds(20), 1);
  SyntheticImuSettings settings = settings_for(seconds(20));
  settings.gyro.noise_density = 2e-3;
  settings.gyro.bias = {0.1, -0.2, 0.3};
  settings.accel.scale = {1.02, 1.0, 1.0};
  const auto imu = make_imu(settings, motion);
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  Eigen::Array3d squares = Eigen::Array3d::Zero();
  for (const GyroSample& sample : imu->gyro()) {
    const Eigen::Array3d error = sample.gyro_rad_s.array() - settings.gyro.bias.array();
    sum += error;
    squares += error.square();
  }
  const auto count = static_cast<double>(imu->gyro().size());
  const double sigma = 2e-3 * std::sqrt(500.0);  // the density over the band up to half the rate
  EXPECT_LT((sum / count).abs().maxCoeff(), 5 * sigma / std::sqrt(count));
  EXPECT_LT(((squares / count).sqrt() / sigma - 1.0).abs().maxCoeff(), 5 / std::sqrt(2 * count));
  EXPECT_NEAR(imu->accel().front().accel_m_s2.x(), 1.02 * 9.80665, 1e-9);
}

TEST(SyntheticImu, BiasWalksAsTheRootOfTime) {
  const Motion motion = make_hand_motion(tripod(), seconds(20), 1);
  SyntheticImuSettings settings = settings_for(seconds(20));
  settings.gyro.bias_walk = 1e-3;
  const auto imu = make_imu(settings, motion);
  double squares = 0;
  int count = 0;
  for (std::size_t i = 1000; i < imu->gyro_bias().size(); i += 1000, ++count) {
    squares += (imu->gyro_bias()[i] - imu->gyro_bias()[i - 1000]).squaredNorm() / 3.0;
  }
  const double per_second = std::sqrt(squares / count);
  EXPECT_NEAR(per_second, 1e-3, 5 * 1e-3 / std::sqrt(2.0 * 3.0 * count));
}

TEST(SyntheticImu, SaturatesAtFullScale) {
  SyntheticImuSettings settings = settings_for(seconds(4));
  settings.gyro.full_scale = 0.5;
  HandModel model;
  model.pan = {2.0, seconds(2), seconds(1)};  // peaks at 2 rad/s
  const auto imu = make_imu(settings, make_hand_motion(model, seconds(4), 1));
  double most = 0;
  for (const GyroSample& sample : imu->gyro()) {
    most = std::max(most, sample.gyro_rad_s.cwiseAbs().maxCoeff());
  }
  EXPECT_EQ(most, 0.5);
}

TEST(SyntheticImu, DropoutsLoseSamplesAndTheClockOffsetMovesStamps) {
  const Motion motion = make_hand_motion(walking_hand(), seconds(2), 1);
  SyntheticImuSettings settings = settings_for(seconds(2));
  const auto whole = make_imu(settings, motion);
  settings.dropouts = {{SensorTime(milliseconds(500)), SensorTime(milliseconds(735))}};
  settings.clock_offset = milliseconds(40);
  const auto broken = make_imu(settings, motion);
  ASSERT_EQ(broken->gyro().size(), whole->gyro().size() - 235);
  EXPECT_EQ(broken->gyro()[499].time, SensorTime(milliseconds(539)));
  EXPECT_EQ(broken->gyro()[500].time, SensorTime(milliseconds(775)));
  EXPECT_EQ(broken->gyro()[500].gyro_rad_s, whole->gyro()[735].gyro_rad_s);
}

TEST(SyntheticImu, SeedDecidesAndSensorsHaveNoiseOfTheirOwn) {
  const Motion motion = make_hand_motion(tripod(), seconds(1), 1);
  SyntheticImuSettings settings = settings_for(seconds(1));
  settings.gyro.noise_density = 1e-3;
  settings.accel.noise_density = 1e-3;
  const auto first = make_imu(settings, motion);
  const auto same = make_imu(settings, motion);
  settings.accel_clock.rate_hz = 0;
  const auto no_accel = make_imu(settings, motion);
  settings.seed = 1;
  const auto other = make_imu(settings, motion);
  EXPECT_EQ(first->gyro()[7].gyro_rad_s, same->gyro()[7].gyro_rad_s);
  EXPECT_EQ(first->gyro()[7].gyro_rad_s, no_accel->gyro()[7].gyro_rad_s);
  EXPECT_NE(first->gyro()[7].gyro_rad_s, other->gyro()[7].gyro_rad_s);
  EXPECT_TRUE(no_accel->accel().empty());
}

TEST(SyntheticImu, RefusesWhatNoImuIs) {
  const Motion motion = make_hand_motion(tripod(), seconds(1), 1);
  SyntheticImuSettings mirrored = settings_for(seconds(1));
  mirrored.R_camera_imu = Eigen::Vector3d(1, 1, -1).asDiagonal();
  EXPECT_FALSE(SyntheticImu::create(mirrored, motion).has_value());
  SyntheticImuSettings backwards = settings_for(seconds(-1));
  EXPECT_FALSE(SyntheticImu::create(backwards, motion).has_value());
  SyntheticImuSettings too_fast = settings_for(seconds(1));
  too_fast.gyro_clock.rate_hz = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(SyntheticImu::create(too_fast, motion).has_value());
}

}  // namespace
}  // namespace gimbal
