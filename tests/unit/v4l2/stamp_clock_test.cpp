#include "drivers/v4l2/stamp_clock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <chrono>
#include <map>

namespace gimbal {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

constexpr std::uint32_t kMonotonic = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;

ReadClock clocks(std::map<StampClock, SensorDuration> times) {
  return [times = std::move(times)](StampClock clock) -> std::optional<SensorDuration> {
    const auto found = times.find(clock);
    return found == times.end() ? std::nullopt : std::optional(found->second);
  };
}

const ReadClock& after_a_suspend() {
  static const ReadClock read = clocks({{StampClock::monotonic, hours(10)},
                                        {StampClock::boottime, hours(12)},
                                        {StampClock::realtime, hours(480'000)}});
  return read;
}

TEST(FindClock, TakesTheOneByWhichThePictureIsFresh) {
  EXPECT_EQ(find_clock(hours(10) - milliseconds(30), after_a_suspend()), StampClock::monotonic);
  EXPECT_EQ(find_clock(hours(12) - milliseconds(30), after_a_suspend()), StampClock::boottime);
  EXPECT_EQ(find_clock(hours(480'000) - milliseconds(30), after_a_suspend()), StampClock::realtime);
}

TEST(FindClock, OfEqualClocksTheMonotonicOneIsMeant) {
  const auto never_suspended =
      clocks({{StampClock::boottime, hours(10)}, {StampClock::monotonic, hours(10)}});
  EXPECT_EQ(find_clock(hours(10) - milliseconds(30), never_suspended), StampClock::monotonic);
}

TEST(FindClock, AStampFromNowhereHasNone) {
  EXPECT_FALSE(find_clock(hours(11), after_a_suspend()));
  EXPECT_FALSE(find_clock(SensorDuration::zero(), after_a_suspend()));
  EXPECT_FALSE(find_clock(hours(10) + milliseconds(20), after_a_suspend()));  // of the future
  EXPECT_FALSE(find_clock(hours(10) - seconds(3), after_a_suspend()));
}

TEST(OddityOf, OnlyWhatFitsTheFlagsIsNotOdd) {
  EXPECT_EQ(oddity_of(StampClock::monotonic, kMonotonic), "");
  EXPECT_THAT(oddity_of(StampClock::system_counter, kMonotonic), HasSubstr("system counter"));
  EXPECT_THAT(oddity_of(StampClock::monotonic, V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN),
              HasSubstr("does not say"));
}

TEST(ToMonotonic, KeepsTheAge) {
  const SensorDuration age = milliseconds(45);
  EXPECT_EQ(to_monotonic(hours(12) - age, StampClock::boottime, after_a_suspend()),
            SensorTime(hours(10) - age));
  EXPECT_EQ(to_monotonic(hours(10) - age, StampClock::monotonic, after_a_suspend()),
            SensorTime(hours(10) - age));
}

TEST(ToMonotonic, FollowsAClockThatIsSet) {
  SensorDuration offset = hours(1000);
  const ReadClock read = [&](StampClock clock) -> std::optional<SensorDuration> {
    return clock == StampClock::monotonic ? hours(10) : hours(10) + offset;
  };
  EXPECT_EQ(to_monotonic(hours(1010), StampClock::realtime, read), SensorTime(hours(10)));
  offset = hours(1000) + seconds(7);
  EXPECT_EQ(to_monotonic(hours(1010) + seconds(7), StampClock::realtime, read),
            SensorTime(hours(10)));
}

TEST(ClaimedReference, IsTheEndOfTheFrameWhereNoFlagSaysMore) {
  EXPECT_EQ(claimed_reference(kMonotonic), TimestampReference::readout_end);
  EXPECT_EQ(claimed_reference(kMonotonic | V4L2_BUF_FLAG_TSTAMP_SRC_SOE),
            TimestampReference::exposure_start);
}

TEST(DescribeStamps, SaysClockAndInstant) {
  EXPECT_EQ(describe_stamps(kMonotonic | V4L2_BUF_FLAG_TSTAMP_SRC_SOE),
            "stamps: by CLOCK_MONOTONIC, at the start of exposure (as the driver says)");
  EXPECT_THAT(describe_stamps(0), HasSubstr("an unknown clock, at the end of the frame"));
}

TEST(SequenceCounter, CountsWhatIsSkipped) {
  SequenceCounter counter;
  EXPECT_EQ(counter.next(5).lost, 0U);  // where it begins does not matter
  EXPECT_EQ(counter.next(6).lost, 0U);
  const auto step = counter.next(10);
  EXPECT_EQ(step.lost, 3U);
  EXPECT_EQ(step.index, 5);
}

TEST(SequenceCounter, GoesOnOverTheEndOf32Bits) {
  SequenceCounter counter;
  static_cast<void>(counter.next(0xFFFF'FFFE));
  const auto step = counter.next(1);
  EXPECT_EQ(step.lost, 2U);
  EXPECT_EQ(step.index, 3);
}

TEST(SequenceCounter, NumbersThatDoNotRiseTellNothing) {
  SequenceCounter counter;
  static_cast<void>(counter.next(7));
  EXPECT_EQ(counter.next(7).index, 1);
  const auto step = counter.next(0);  // counted anew
  EXPECT_EQ(step.index, 2);
  EXPECT_EQ(step.lost, 0U);
  EXPECT_EQ(counter.next(1).index, 3);
}

}  // namespace
}  // namespace gimbal
