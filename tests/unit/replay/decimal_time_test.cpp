#include "drivers/replay/decimal_time.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>

namespace gimbal {
namespace {

TEST(ParseTime, KeepsWhatADoubleWouldLose) {
  // The neighbouring doubles of 1627530745.150090 are 0.24 µs apart.
  EXPECT_EQ(parse_time("1627530745.150090", TimeUnit::seconds).value().count(),
            1'627'530'745'150'090'000);
  EXPECT_EQ(parse_time("1627530745.150090123", TimeUnit::seconds).value().count(),
            1'627'530'745'150'090'123);
}

TEST(ParseTime, ReadsEveryNotation) {
  EXPECT_EQ(parse_time("0", TimeUnit::seconds).value().count(), 0);
  EXPECT_EQ(parse_time("-0.5", TimeUnit::seconds).value().count(), -500'000'000);
  EXPECT_EQ(parse_time("+1.", TimeUnit::seconds).value().count(), 1'000'000'000);
  EXPECT_EQ(parse_time(".25", TimeUnit::seconds).value().count(), 250'000'000);
  EXPECT_EQ(parse_time("1e-09", TimeUnit::seconds).value().count(), 1);
  EXPECT_EQ(parse_time("-3.5E+2", TimeUnit::seconds).value().count(), -350'000'000'000);
  EXPECT_EQ(parse_time("000000000000000000000000000001.5", TimeUnit::seconds).value().count(),
            1'500'000'000);
}

TEST(ParseTime, RoundsToTheNearestNanosecond) {
  EXPECT_EQ(parse_time("0.0000000014999", TimeUnit::seconds).value().count(), 1);
  EXPECT_EQ(parse_time("0.0000000015", TimeUnit::seconds).value().count(), 2);
  EXPECT_EQ(parse_time("-0.0000000015", TimeUnit::seconds).value().count(), -2);
  EXPECT_EQ(parse_time("0.00000000049", TimeUnit::seconds).value().count(), 0);
  EXPECT_EQ(parse_time("0.0000000005", TimeUnit::seconds).value().count(), 1);
  EXPECT_EQ(parse_time("1e-4000", TimeUnit::seconds).value().count(), 0);
}

TEST(ParseTime, RefusesWhatIsNoTime) {
  for (const char* text :
       {"", "-", ".", "e5", "1e", "1.2.3", "0x10", "1 2", "12a", "--1", "\0001"}) {
    ASSERT_FALSE(parse_time(text, TimeUnit::seconds).has_value()) << text;
    EXPECT_EQ(parse_time(text, TimeUnit::seconds).error(), TimeTextFault::not_a_number) << text;
  }
  for (const char* text : {"nan", "NaN", "inf", "-inf", "infinity"}) {
    ASSERT_FALSE(parse_time(text, TimeUnit::seconds).has_value()) << text;
    EXPECT_EQ(parse_time(text, TimeUnit::seconds).error(), TimeTextFault::not_finite) << text;
  }
  for (const char* text : {"9223372036.854775808", "1e300", "436000653291125", "-99999999999"}) {
    ASSERT_FALSE(parse_time(text, TimeUnit::seconds).has_value()) << text;
    EXPECT_EQ(parse_time(text, TimeUnit::seconds).error(), TimeTextFault::out_of_range) << text;
  }
}

TEST(FormatSeconds, IsReadBackToTheNanosecond) {
  std::mt19937_64 random(1);
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max() / 2;
  std::uniform_int_distribution<std::int64_t> any(-kMost, kMost);
  for (int i = 0; i < 10'000; ++i) {
    const SensorDuration duration(any(random));
    ASSERT_EQ(parse_time(format_seconds(duration), TimeUnit::seconds).value(), duration);
  }
  EXPECT_EQ(format_seconds(SensorDuration(-1)), "-0.000000001");
}

}  // namespace
}  // namespace gimbal
