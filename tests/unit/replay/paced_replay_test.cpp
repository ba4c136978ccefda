#include "drivers/replay/paced_replay.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <variant>
#include <vector>

#include "drivers/replay/session.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;

/// 100 ms of a gyro at 200 Hz that counts, with an epoch of its own and frames at 100 Hz.
Session short_recording() {
  Session session;
  session.camera.emplace();  // whose time offset holds the IMU's delay
  for (int i = 0; i <= 20; ++i) {
    session.gyro.push_back(
        {SensorTime(std::chrono::hours(1) + milliseconds(5 * i)), {i * 1.0, 0, 0}});
  }
  for (int i = 0; i <= 10; ++i) {
    session.frames.push_back({i, SensorTime(std::chrono::hours(1) + milliseconds(10 * i)), {}});
  }
  return session;
}

SensorTime time_of(const ImuReading& reading) {
  return std::get<GyroSample>(reading).time;
}

TEST(PacedImu, DeliversEachSampleAtItsInstantPassByPassWithoutAGap) {
  const Session session = short_recording();
  const auto timeline = std::make_shared<ReplayTimeline>(session);
  PacedImu imu(session, timeline, Repeat::forever);
  ASSERT_TRUE(imu.start());
  const SensorTime begin = monotonic_now();
  timeline->begin_at(begin);
  for (int i = 0; i < 50; ++i) {
    const auto reading = imu.read();
    ASSERT_TRUE(reading && *reading);
    EXPECT_GE(monotonic_now(), time_of(**reading));
    // A pass is as long as the frames are to keep their rate: 110 ms.
    EXPECT_EQ(time_of(**reading), begin + milliseconds(110 * (i / 21) + 5 * (i % 21)));
  }
}

TEST(PacedImu, ARecordingThatIsPlayedOnceEnds) {
  const Session session = short_recording();
  const auto timeline = std::make_shared<ReplayTimeline>(session);
  timeline->begin_at(monotonic_now());
  PacedImu imu(session, timeline, Repeat::once);
  ASSERT_TRUE(imu.start());
  int samples = 0;
  for (auto reading = imu.read(); reading && *reading; reading = imu.read()) ++samples;
  EXPECT_EQ(samples, 21);
}

TEST(PacedImu, StopWakesTheReader) {
  const Session session = short_recording();
  const auto timeline = std::make_shared<ReplayTimeline>(session);
  timeline->begin_at(monotonic_now() + std::chrono::hours(1));
  PacedImu imu(session, timeline, Repeat::forever);
  ASSERT_TRUE(imu.start());
  std::thread stopper([&] {
    std::this_thread::sleep_for(milliseconds(20));
    imu.stop();
  });
  const auto reading = imu.read();
  ASSERT_TRUE(reading);
  EXPECT_FALSE(*reading);
  stopper.join();
}

}  // namespace
}  // namespace gimbal
