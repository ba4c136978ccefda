#include "drivers/v4l2/stamp_clock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

namespace gimbal {
namespace {

using ::testing::HasSubstr;

constexpr std::uint32_t kMonotonic = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;

TEST(OddityOf, OnlyWhatFitsTheFlagsIsNotOdd) {
  EXPECT_EQ(oddity_of(KernelClock::monotonic, kMonotonic), "");
  EXPECT_THAT(oddity_of(KernelClock::system_counter, kMonotonic), HasSubstr("system counter"));
  EXPECT_THAT(oddity_of(KernelClock::monotonic, V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN),
              HasSubstr("does not say"));
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

}  // namespace
}  // namespace gimbal
