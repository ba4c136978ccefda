#include "drivers/replay/replay_imu.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace gimbal {
namespace {

SensorTime at(std::int64_t milliseconds) {
  return SensorTime(std::chrono::milliseconds(milliseconds));
}

Session two_rates() {
  Session session;
  for (int i = 0; i < 20; ++i) session.gyro.push_back({at(5 * i), {i * 1.0, 0, 0}});
  for (int i = 0; i < 5; ++i) session.accel.push_back({at(7 + 14 * i), {0, i * 1.0, 0}});
  session.accel.push_back({at(95), {0, 0, 1}});  // the last gyro sample's instant
  return session;
}

std::vector<ImuReading> read_all(ReplayImu& imu) {
  std::vector<ImuReading> readings;
  while (true) {
    const auto reading = imu.read();
    EXPECT_TRUE(reading);
    if (!reading || !*reading) return readings;
    readings.push_back(**reading);
  }
}

SensorTime time_of(const ImuReading& reading) {
  return std::visit([](const auto& sample) { return sample.time; }, reading);
}

TEST(ReplayImu, MergesBothSensorsInOrderOfTimeAndLosesNothing) {
  ReplayImu imu(two_rates());
  ASSERT_TRUE(imu.start());
  const std::vector<ImuReading> readings = read_all(imu);
  ASSERT_EQ(readings.size(), 26U);
  int next_gyro = 0;
  int next_accel = 0;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    ASSERT_GE(time_of(readings[i]), time_of(readings[i == 0 ? 0 : i - 1]));
    if (const auto* gyro = std::get_if<GyroSample>(&readings[i])) {
      EXPECT_EQ(gyro->gyro_rad_s.x(), next_gyro++);
    } else if (next_accel < 5) {
      EXPECT_EQ(std::get<AccelSample>(readings[i]).accel_m_s2.y(), next_accel++);
    }
  }
  EXPECT_EQ(next_gyro, 20);
  EXPECT_EQ(next_accel, 5);
}

SensorDuration shift_of_first_gyro(const Session& session) {
  ReplayImu imu(session);
  EXPECT_TRUE(imu.start());
  return session.gyro.front().time - time_of(read_all(imu).front());
}

TEST(ReplayImu, TakesTheSensorsDelayOffTheStamps) {
  Session session = two_rates();
  EXPECT_EQ(shift_of_first_gyro(session), std::chrono::microseconds(2500));  // the usual one
  session.camera.emplace();
  EXPECT_EQ(shift_of_first_gyro(session), SensorDuration::zero());  // in the camera's time offset
  session.imu.delay = std::chrono::milliseconds(4);
  EXPECT_EQ(shift_of_first_gyro(session), std::chrono::milliseconds(4));
}

TEST(ReplayImu, GivesTheAccelerometerFirstAtTheSameInstant) {
  ReplayImu imu(two_rates());
  ASSERT_TRUE(imu.start());
  const std::vector<ImuReading> readings = read_all(imu);
  EXPECT_TRUE(std::holds_alternative<AccelSample>(readings[24]));
  EXPECT_TRUE(std::holds_alternative<GyroSample>(readings[25]));
  EXPECT_EQ(time_of(readings[24]), time_of(readings[25]));
}

TEST(ReplayImu, BeginsAgainAfterEveryStart) {
  ReplayImu imu(two_rates());
  EXPECT_TRUE(read_all(imu).empty());
  ASSERT_TRUE(imu.start());
  ASSERT_TRUE(imu.read());
  imu.stop();
  EXPECT_TRUE(read_all(imu).empty());
  ASSERT_TRUE(imu.start());
  EXPECT_EQ(read_all(imu).size(), 26U);
}

TEST(ReplayImu, TakesAGyroAlone) {
  Session session = two_rates();
  session.accel.clear();
  ReplayImu imu(session);
  ASSERT_TRUE(imu.start());
  EXPECT_EQ(read_all(imu).size(), 20U);
}

}  // namespace
}  // namespace gimbal
