#include "drivers/gpio/flash_timing.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>

namespace gimbal {
namespace {

using std::chrono::microseconds;

constexpr SensorDuration kHalf = microseconds(1000);  // 500 Hz

TEST(FlashTiming, TellsEvenChanges) {
  FlashTiming timing(kHalf);
  EXPECT_DOUBLE_EQ(timing.hz(), 500);
  for (std::int64_t step = 0; step < 1000; ++step) {
    timing.add(step, SensorTime(microseconds(70'000'000 + 1000 * step)));
  }
  EXPECT_NEAR(timing.hz(), 500, 1e-9);
  EXPECT_NEAR(timing.jitter_s(), 0, 1e-12);
}

// A clock that is 2 in 1000 slow, and changes that come late in turn by 0 and 40 µs: 20 from their
// mean.
TEST(FlashTiming, TellsWhatWasKeptAndHowUnevenly) {
  FlashTiming timing(kHalf);
  for (std::int64_t step = 0; step < 4000; ++step) {
    if (step % 7 == 3) continue;  // left out
    timing.add(step, SensorTime(microseconds(1002 * step + 40 * (step / 2 % 2))));
  }
  EXPECT_NEAR(timing.hz(), 500 / 1.002, 1e-3);
  EXPECT_NEAR(timing.jitter_s(), 20e-6, 0.1e-6);
}

}  // namespace
}  // namespace gimbal
