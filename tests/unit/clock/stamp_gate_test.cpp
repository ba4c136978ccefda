#include "drivers/clock/stamp_gate.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <vector>

namespace gimbal {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr SensorTime kHostStart{std::chrono::hours(3)};
constexpr SensorDuration kPeriod = milliseconds(5);

/// A device that samples every 5 ms and whose samples arrive 2 ms later.
class StampGateTest : public ::testing::Test {
 protected:
  Result<std::optional<SensorTime>> pass(SensorDuration instant, SensorDuration clock_ahead) {
    const SensorTime stamp = kHostStart + instant + clock_ahead;
    return gate_.pass(stamp, kHostStart + instant + milliseconds(2));
  }

  /// Passes `count` samples from `from` on; what came out.
  std::vector<SensorTime> pass_run(SensorDuration from, int count, SensorDuration clock_ahead) {
    std::vector<SensorTime> out;
    for (int i = 0; i < count; ++i) {
      const auto time = pass(from + i * kPeriod, clock_ahead);
      EXPECT_TRUE(time) << time.error().message;
      if (time && *time) out.push_back(**time);
    }
    return out;
  }

  StampGate gate_{"iio:device0", ForeignClock::map};
};

void expect_rising(const std::vector<SensorTime>& times) {
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_GT(times[i], times[i - 1]) << i;
}

TEST_F(StampGateTest, LeavesStampsOfTheRightClockAsTheyAre) {
  const auto out = pass_run({}, 400, {});
  ASSERT_EQ(out.size(), 400U);
  for (std::size_t i = 0; i < out.size(); ++i) {
    EXPECT_EQ(out[i], kHostStart + static_cast<std::int64_t>(i) * kPeriod);
  }
  EXPECT_TRUE(gate_.remarks().empty());
}

TEST_F(StampGateTest, ForeignStampsAreRefusedWhereThatIsAsked) {
  StampGate strict("gyro_3d", ForeignClock::refuse);
  const auto time = strict.pass(kHostStart - seconds(40), kHostStart);
  ASSERT_FALSE(time);
  EXPECT_NE(time.error().message.find("gyro_3d"), std::string::npos);
  EXPECT_NE(time.error().message.find("40.000 s off CLOCK_MONOTONIC"), std::string::npos);
}

TEST_F(StampGateTest, MapsAClockOfItsOwnByTheLeastDelay) {
  std::mt19937 random(7);
  std::exponential_distribution<double> delay_ms(1 / 2.0);
  double worst_ms = 0;
  std::vector<SensorTime> out;
  for (int i = 0; i < 60 * 200; ++i) {
    const SensorDuration instant = i * kPeriod;
    const SensorDuration drift = instant / 20'000;  // 50 ppm
    const SensorTime stamp = SensorTime(seconds(9)) + instant + drift;
    const auto late = microseconds(static_cast<std::int64_t>(1000 * delay_ms(random)));
    const auto time = gate_.pass(stamp, kHostStart + instant + late);
    ASSERT_TRUE(time && *time);
    out.push_back(**time);
    if (i > 20 * 200) {
      const double error_ms = 1e3 * to_seconds(**time - (kHostStart + instant));
      worst_ms = std::max(worst_ms, std::abs(error_ms));
    }
  }
  expect_rising(out);
  EXPECT_LT(worst_ms, 1.0);  // two windows of drift are 0.5 ms
  ASSERT_EQ(gate_.remarks().size(), 1U);
}

TEST_F(StampGateTest, APauseOfTheDeviceIsNoJump) {
  pass_run({}, 100, {});
  const auto out = pass_run(seconds(8), 100, {});
  ASSERT_EQ(out.size(), 100U);
  EXPECT_EQ(out.front(), kHostStart + seconds(8));
  EXPECT_EQ(gate_.jumps(), 0U);
  EXPECT_EQ(gate_.refused(), 0U);
}

TEST_F(StampGateTest, AJumpOfTheClockIsCountedAndDoesNotReachTheOutput) {
  for (const SensorDuration jump : {SensorDuration(seconds(5)), SensorDuration(-seconds(5))}) {
    gate_ = StampGate("iio:device0", ForeignClock::map);
    auto out = pass_run({}, 100, {});
    const auto after = pass_run(100 * kPeriod, 400, jump);
    out.insert(out.end(), after.begin(), after.end());
    expect_rising(out);
    EXPECT_EQ(out.size(), 498U);  // two were needed to see that the new clock is steady
    EXPECT_EQ(gate_.refused(), 2U);
    EXPECT_EQ(gate_.jumps(), 1U);
    EXPECT_LT(std::abs(to_seconds(out.back() - (kHostStart + 499 * kPeriod))), 0.003);
  }
}

TEST_F(StampGateTest, ComesBackToTheRightClockExactly) {
  pass_run({}, 100, {});
  pass_run(100 * kPeriod, 100, seconds(5));
  const auto out = pass_run(200 * kPeriod, 100, {});
  EXPECT_EQ(gate_.jumps(), 2U);
  EXPECT_EQ(out.back(), kHostStart + 299 * kPeriod);
}

TEST_F(StampGateTest, OneWildStampIsLeftOutAlone) {
  pass_run({}, 100, {});
  pass_run(100 * kPeriod, 1, seconds(60));
  const auto out = pass_run(101 * kPeriod, 100, {});
  EXPECT_EQ(out.size(), 100U);
  EXPECT_EQ(gate_.refused(), 1U);
  EXPECT_EQ(gate_.jumps(), 0U);
}

TEST_F(StampGateTest, AStampThatIsNotLaterIsRefused) {
  pass_run({}, 100, {});
  EXPECT_TRUE(pass_run(99 * kPeriod, 1, {}).empty());  // the same once more
  EXPECT_TRUE(pass_run(98 * kPeriod, 1, {}).empty());
  EXPECT_EQ(pass_run(100 * kPeriod, 1, {}).size(), 1U);
  EXPECT_EQ(gate_.refused(), 2U);
}

TEST_F(StampGateTest, StrictAfterAJumpIsAnError) {
  gate_ = StampGate("iio:device0", ForeignClock::refuse);
  pass_run({}, 10, {});
  bool has_failed = false;
  for (int i = 10; i < 20 && !has_failed; ++i) has_failed = !pass(i * kPeriod, seconds(5));
  EXPECT_TRUE(has_failed);
}

}  // namespace
}  // namespace gimbal
