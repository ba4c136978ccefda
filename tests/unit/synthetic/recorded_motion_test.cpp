#include "drivers/synthetic/recorded_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "drivers/replay/session.hpp"
#include "drivers/synthetic/hand_motion.hpp"
#include "drivers/synthetic/synthetic_imu.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

Result<MotionLog> iphone_log() {
  return open_session(GIMBALD_MOTIONS "/iphone-handheld").map([](const Session& session) {
    return MotionLog{session.gyro, session.accel, session.imu.R_camera_imu};
  });
}

TEST(RecordedMotion, FindsTheInclinationAndBiasBehindALog) {
  // A motion that is known makes the log; its IMU is turned, biased and noisy.
  HandModel model = walking_hand();
  model.pitch_rad = -0.4;
  const Motion truth = make_hand_motion(model, seconds(21), 3);
  SyntheticImuSettings settings;
  settings.R_camera_imu << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  settings.span = {SensorTime(milliseconds(100)), SensorTime(seconds(21))};
  settings.gyro_clock = {100.0, milliseconds(0)};
  settings.accel_clock = {100.0, milliseconds(3)};
  settings.gyro.bias = {0.01, -0.02, 0.015};
  settings.gyro.noise_density = 1e-4;
  const auto imu = SyntheticImu::create(settings, truth);
  ASSERT_TRUE(imu.has_value());
  const auto motion = make_recorded_motion({(*imu)->gyro(), (*imu)->accel(), settings.R_camera_imu},
                                           {}, seconds(20));
  ASSERT_TRUE(motion.has_value()) << motion.error().message;
  for (SensorTime t(seconds(1)); t < SensorTime(seconds(19)); t += milliseconds(487)) {
    const Eigen::Vector3d up_truth =
        truth.at(t + milliseconds(100)).q_world_camera.conjugate() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d up = motion->at(t).q_world_camera.conjugate() * Eigen::Vector3d::UnitZ();
    EXPECT_LT(std::acos(std::min(1.0, up.dot(up_truth))), 0.01) << seconds_since_epoch(t);
    EXPECT_LT((motion->at(t).rate_rad_s - truth.at(t + milliseconds(100)).rate_rad_s).norm(), 0.15);
  }
}

TEST(RecordedMotion, StartsWithItsHeadingAlongX) {
  const Result<MotionLog> log = iphone_log();
  ASSERT_TRUE(log.has_value()) << log.error().message;
  const auto motion = make_recorded_motion(*log, seconds(3), seconds(2));
  ASSERT_TRUE(motion.has_value()) << motion.error().message;
  const Eigen::Vector3d forward =
      motion->at(SensorTime()).q_world_camera * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(std::atan2(forward.y(), forward.x()), 0.0, 0.02);
}

TEST(RecordedMotion, ALaterStartSeesTheSameMotion) {
  const Result<MotionLog> log = iphone_log();
  ASSERT_TRUE(log.has_value()) << log.error().message;
  const auto whole = make_recorded_motion(*log, {}, seconds(30));
  const auto part = make_recorded_motion(*log, milliseconds(12345), seconds(3));
  ASSERT_TRUE(whole.has_value() && part.has_value());
  for (SensorTime t; t < SensorTime(seconds(3)); t += milliseconds(97)) {
    const Eigen::Vector3d expected = whole->at(t + milliseconds(12345)).rate_rad_s;
    EXPECT_LT((part->at(t).rate_rad_s - expected).norm(), 1e-9);
  }
}

/// The phone's own tracking (ARKit, camera and IMU together) is an independent witness of
/// inclination and of turning. Its camera axes are x right, y up, z back; its world is y up.
TEST(RecordedMotion, IphoneAgreesWithItsOwnVisualTracking) {
  const std::string path = GIMBALD_SHARED "/data/logs/iphone-handheld/orientation_ref.csv";
  std::ifstream file(path);
  if (!file) GTEST_SKIP() << "no recordings: " << path;
  const Result<MotionLog> log = iphone_log();
  ASSERT_TRUE(log.has_value()) << log.error().message;
  const auto motion = make_recorded_motion(*log, {}, seconds(32));
  ASSERT_TRUE(motion.has_value()) << motion.error().message;
  Eigen::Matrix3d R_arkit_imu;
  R_arkit_imu << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const Eigen::Matrix3d R_arkit_camera = R_arkit_imu * log->R_camera_imu.transpose();
  std::string line;
  std::getline(file, line);
  double sum_deg = 0;
  double most_deg = 0;
  int count = 0;
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    double t, w, x, y, z;
    char comma;
    fields >> t >> comma >> w >> comma >> x >> comma >> y >> comma >> z;
    const SensorTime time =
        SensorTime(time_from_seconds(t) - log->gyro.front().time);  // the motion's zero
    if (time < SensorTime(milliseconds(100)) || time > SensorTime(milliseconds(31900))) continue;
    const Eigen::Matrix3d R_reference =
        Eigen::Quaterniond(w, x, y, z).toRotationMatrix() * R_arkit_camera;
    const Eigen::Vector3d up_reference = R_reference.transpose() * Eigen::Vector3d::UnitY();
    const Eigen::Vector3d up =
        motion->at(time).q_world_camera.conjugate() * Eigen::Vector3d::UnitZ();
    const double deg = std::acos(std::min(1.0, up.dot(up_reference))) * 180.0 / 3.14159265358979;
    sum_deg += deg;
    most_deg = std::max(most_deg, deg);
    ++count;
  }
  ASSERT_GT(count, 1500);
  std::printf("inclination against ARKit: mean %.2f deg, most %.2f deg\n", sum_deg / count,
              most_deg);
  EXPECT_LT(sum_deg / count, 1.5);
  EXPECT_LT(most_deg, 5.0);
}

TEST(RecordedMotion, RefusesWhatTheLogDoesNotHold) {
  const Result<MotionLog> log = iphone_log();
  ASSERT_TRUE(log.has_value()) << log.error().message;
  EXPECT_FALSE(make_recorded_motion(*log, seconds(30), seconds(10)).has_value());
  EXPECT_FALSE(make_recorded_motion(*log, seconds(-1), seconds(10)).has_value());
  EXPECT_FALSE(make_recorded_motion(*log, {}, {}).has_value());
  EXPECT_FALSE(make_recorded_motion({}, {}, seconds(1)).has_value());
}

TEST(RecordedMotion, StartsLevelWithoutAnAccelerometer) {
  Result<MotionLog> log = iphone_log();
  ASSERT_TRUE(log.has_value()) << log.error().message;
  log->accel.clear();
  const auto motion = make_recorded_motion(*log, {}, seconds(2));
  ASSERT_TRUE(motion.has_value()) << motion.error().message;
  const Eigen::Vector3d up =
      motion->at(SensorTime()).q_world_camera.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_LT((up - Eigen::Vector3d(0, -1, 0)).norm(), 0.02);
}

}  // namespace
}  // namespace gimbal
