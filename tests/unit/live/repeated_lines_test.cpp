#include "daemon/repeated_lines.hpp"

#include <gtest/gtest.h>

namespace gimbal {
namespace {

using std::chrono::seconds;

constexpr RepeatedLines::Clock::time_point kBegin{};

TEST(RepeatedLines, AFaultThatComesEverySecondIsToldNowAndThen) {
  RepeatedLines lines;
  std::uint64_t told = 0;
  std::uint64_t held_back = 0;
  for (int second = 0; second < 300; ++second) {
    if (const auto passed = lines.pass("the cable is loose", kBegin + seconds(second))) {
      ++told;
      held_back += passed->held_back;
    }
  }
  EXPECT_GE(told, 10U);
  EXPECT_LE(told, 30U);
  // Those after the last one that passed are not told yet.
  EXPECT_NEAR(static_cast<double>(told + held_back), 300, 30);
}

TEST(RepeatedLines, OtherLinesPass) {
  RepeatedLines lines;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_TRUE(lines.pass("line " + std::to_string(i), kBegin));
  }
}

TEST(RepeatedLines, AFewAtOncePass) {
  RepeatedLines lines;
  EXPECT_TRUE(lines.pass("again", kBegin));
  EXPECT_TRUE(lines.pass("again", kBegin));
  EXPECT_TRUE(lines.pass("again", kBegin));
  EXPECT_FALSE(lines.pass("again", kBegin));
  const auto later = lines.pass("again", kBegin + seconds(31));
  ASSERT_TRUE(later);
  EXPECT_EQ(later->held_back, 1U);
}

}  // namespace
}  // namespace gimbal
