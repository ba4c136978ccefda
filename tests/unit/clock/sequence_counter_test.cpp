#include "drivers/clock/sequence_counter.hpp"

#include <gtest/gtest.h>

namespace gimbal {
namespace {

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
