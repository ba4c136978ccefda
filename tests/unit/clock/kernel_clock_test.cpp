#include "drivers/clock/kernel_clock.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <utility>

namespace gimbal {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

ReadClock clocks(std::map<KernelClock, SensorDuration> times) {
  return [times = std::move(times)](KernelClock clock) -> std::optional<SensorDuration> {
    const auto found = times.find(clock);
    return found == times.end() ? std::nullopt : std::optional(found->second);
  };
}

const ReadClock& after_a_suspend() {
  static const ReadClock read = clocks({{KernelClock::monotonic, hours(10)},
                                        {KernelClock::boottime, hours(12)},
                                        {KernelClock::realtime, hours(480'000)}});
  return read;
}

TEST(FindClock, TakesTheOneByWhichThePictureIsFresh) {
  EXPECT_EQ(find_clock(hours(10) - milliseconds(30), after_a_suspend()), KernelClock::monotonic);
  EXPECT_EQ(find_clock(hours(12) - milliseconds(30), after_a_suspend()), KernelClock::boottime);
  EXPECT_EQ(find_clock(hours(480'000) - milliseconds(30), after_a_suspend()),
            KernelClock::realtime);
}

TEST(FindClock, APictureMayBeStampedWithItsPlannedEnd) {
  EXPECT_EQ(find_clock(hours(10) + milliseconds(34), after_a_suspend()), KernelClock::monotonic);
}

TEST(FindClock, OfEqualClocksTheMonotonicOneIsMeant) {
  const auto never_suspended =
      clocks({{KernelClock::boottime, hours(10)}, {KernelClock::monotonic, hours(10)}});
  EXPECT_EQ(find_clock(hours(10) - milliseconds(30), never_suspended), KernelClock::monotonic);
}

TEST(FindClock, AStampFromNowhereHasNone) {
  EXPECT_FALSE(find_clock(hours(11), after_a_suspend()));
  EXPECT_FALSE(find_clock(SensorDuration::zero(), after_a_suspend()));
  EXPECT_FALSE(find_clock(hours(10) + milliseconds(80), after_a_suspend()));  // of the future
  EXPECT_FALSE(find_clock(hours(10) - seconds(3), after_a_suspend()));
}

TEST(ToMonotonic, KeepsTheAge) {
  const SensorDuration age = milliseconds(45);
  EXPECT_EQ(to_monotonic(hours(12) - age, KernelClock::boottime, after_a_suspend()),
            SensorTime(hours(10) - age));
  EXPECT_EQ(to_monotonic(hours(10) - age, KernelClock::monotonic, after_a_suspend()),
            SensorTime(hours(10) - age));
}

TEST(ToMonotonic, FollowsAClockThatIsSet) {
  SensorDuration offset = hours(1000);
  const ReadClock read = [&](KernelClock clock) -> std::optional<SensorDuration> {
    return clock == KernelClock::monotonic ? hours(10) : hours(10) + offset;
  };
  EXPECT_EQ(to_monotonic(hours(1010), KernelClock::realtime, read), SensorTime(hours(10)));
  offset = hours(1000) + seconds(7);
  EXPECT_EQ(to_monotonic(hours(1010) + seconds(7), KernelClock::realtime, read),
            SensorTime(hours(10)));
}

TEST(ReadKernelClock, ReadsThoseThatEveryKernelHas) {
  const auto before = std::chrono::steady_clock::now().time_since_epoch();
  const auto now = read_kernel_clock(KernelClock::monotonic);
  const auto after = std::chrono::steady_clock::now().time_since_epoch();
  ASSERT_TRUE(now);
  EXPECT_GE(*now, before);
  EXPECT_LE(*now, after);
  EXPECT_GE(read_kernel_clock(KernelClock::boottime), before);
  EXPECT_GT(read_kernel_clock(KernelClock::realtime), hours(24 * 365 * 50));
}

}  // namespace
}  // namespace gimbal
