#include "drivers/v4l2/colorimetry.hpp"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

namespace gimbal {
namespace {

// Expected values: the tables of userspace-api/media/v4l/colorspaces-details.rst, in the numbers of
// GStreamer's range:matrix:transfer:primaries.

std::string colorimetry(std::uint32_t colorspace) {
  return color_info({colorspace, 0, 0, 0}, ChromaSiting::left).colorimetry;
}

TEST(Colorimetry, DefaultsFollowFromTheColourSpace) {
  EXPECT_EQ(colorimetry(V4L2_COLORSPACE_REC709), "bt709");
  EXPECT_EQ(colorimetry(V4L2_COLORSPACE_SMPTE170M), "bt601");
  EXPECT_EQ(colorimetry(V4L2_COLORSPACE_JPEG), "1:4:7:1");
  EXPECT_EQ(colorimetry(V4L2_COLORSPACE_SRGB), "2:4:7:1");
  EXPECT_EQ(colorimetry(V4L2_COLORSPACE_BT2020), "2:6:5:7");
  EXPECT_EQ(colorimetry(V4L2_COLORSPACE_SMPTE240M), "2:5:6:5");
}

TEST(Colorimetry, WhatTheDriverSaysGoesFirst) {
  const ColorFields fields = {V4L2_COLORSPACE_REC709, V4L2_YCBCR_ENC_601,
                              V4L2_QUANTIZATION_FULL_RANGE, V4L2_XFER_FUNC_SRGB};
  EXPECT_EQ(color_info(fields, ChromaSiting::left).colorimetry, "1:4:7:1");
}

TEST(Colorimetry, UnknownStaysUnknown) {
  EXPECT_EQ(colorimetry(V4L2_COLORSPACE_DEFAULT), "");
  EXPECT_EQ(colorimetry(V4L2_COLORSPACE_RAW), "");
}

TEST(Colorimetry, SitingIsPassedOn) {
  EXPECT_EQ(color_info({}, ChromaSiting::center).chroma_siting, ChromaSiting::center);
  EXPECT_EQ(color_info({}, ChromaSiting::left).chroma_siting, ChromaSiting::left);
}

}  // namespace
}  // namespace gimbal
