#include "drivers/synthetic/random.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace gimbal {
namespace {

TEST(Random, NormalHasTheMomentsOfANormalDistribution) {
  constexpr int kCount = 200000;
  Random random(11);
  double sum = 0;
  double squares = 0;
  double fourth_powers = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
    fourth_powers += x * x * x * x;
  }
  // Five standard errors: 1/sqrt(n), sqrt(2/n) and sqrt(96/n).
  EXPECT_NEAR(sum / kCount, 0.0, 5 * std::sqrt(1.0 / kCount));
  EXPECT_NEAR(squares / kCount, 1.0, 5 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(fourth_powers / kCount, 3.0, 5 * std::sqrt(96.0 / kCount));
}

TEST(Random, UniformFillsItsRange) {
  constexpr int kCount = 100000;
  Random random(12);
  double sum = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.uniform(2.0, 5.0);
    ASSERT_GE(x, 2.0);
    ASSERT_LT(x, 5.0);
    sum += x;
  }
  EXPECT_NEAR(sum / kCount, 3.5, 5 * 3.0 / std::sqrt(12.0 * kCount));
}

TEST(Random, DrawsFromTheEngineThatTheStandardLaysDown) {
  // [rand.predef]: the 10000th number of a default std::mt19937_64 (seed 5489) is
  // 9981545732273789042, of which a double takes the 53 upper bits.
  Random random(5489);
  double last = 0;
  for (int i = 0; i < 10000; ++i) last = random.uniform();
  EXPECT_EQ(last, static_cast<double>(9981545732273789042U >> 11U) * 0x1p-53);
}

TEST(Random, StreamsOfASeedDiffer) {
  EXPECT_NE(stream_seed(1, 0), stream_seed(1, 1));
  EXPECT_NE(stream_seed(1, 0), stream_seed(2, 0));
}

}  // namespace
}  // namespace gimbal
