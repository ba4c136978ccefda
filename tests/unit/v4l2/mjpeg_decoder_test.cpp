#include "drivers/v4l2/mjpeg_decoder.hpp"

#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <array>
#include <cmath>
#include <vector>

namespace gimbal {
namespace {

constexpr ImageSize kSize = {37, 23};  // odd, and no multiple of a JPEG block

/// Slow enough to survive coding: a slope in luma, another in each chroma.
double y_at(double x, double y) {
  return 60 + 2.5 * x + 1.5 * y;
}
double u_at(double x, double y) {
  return 100 + 1.2 * x - 0.5 * y;
}
double v_at(double x, double y) {
  return 150 - 1.1 * x + 0.7 * y;
}

/// Full-range Y'CbCr of BT.601 back to RGB (JFIF 1.02, p. 3).
std::vector<std::uint8_t> rgb_picture() {
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const double luma = y_at(x, y);
      const double cb = u_at(x, y) - 128;
      const double cr = v_at(x, y) - 128;
      for (const double value :
           {luma + 1.402 * cr, luma - 0.34414 * cb - 0.71414 * cr, luma + 1.772 * cb}) {
        pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L)));
      }
    }
  }
  return pixels;
}

std::vector<std::uint8_t> encode(int subsampling) {
  const auto pixels = rgb_picture();
  unsigned char* jpeg = nullptr;
  unsigned long bytes = 0;
  const tjhandle handle = tjInitCompress();
  const int status = tjCompress2(handle, pixels.data(), kSize.width, 0, kSize.height, TJPF_RGB,
                                 &jpeg, &bytes, subsampling, 98, 0);
  EXPECT_EQ(status, 0);
  std::vector<std::uint8_t> picture(jpeg, jpeg + bytes);
  tjFree(jpeg);
  tjDestroy(handle);
  return picture;
}

class MjpegDecoderTest : public ::testing::TestWithParam<int> {};

TEST_P(MjpegDecoderTest, GivesBackThePicture) {
  MjpegDecoder decoder;
  const auto picture = decoder.decode(encode(GetParam()), kSize);
  ASSERT_TRUE(picture);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      EXPECT_NEAR(picture->luma().data[y * picture->luma().stride_bytes + x], y_at(x, y), 4);
    }
  }
  const ImageSize chroma = chroma_size(kSize);
  for (int y = 0; y < chroma.height; ++y) {
    const std::uint8_t* row = picture->chroma().data + y * picture->chroma().stride_bytes;
    for (int x = 0; x < chroma.width; ++x) {
      EXPECT_NEAR(row[2 * x], u_at(2 * x + 0.5, 2 * y + 0.5), 4);
      EXPECT_NEAR(row[2 * x + 1], v_at(2 * x + 0.5, 2 * y + 0.5), 4);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Subsamplings, MjpegDecoderTest,
                         ::testing::Values(TJSAMP_420, TJSAMP_422, TJSAMP_440, TJSAMP_444));

TEST(MjpegDecoder, GreyHasNoColour) {
  MjpegDecoder decoder;
  const auto picture = decoder.decode(encode(TJSAMP_GRAY), kSize);
  ASSERT_TRUE(picture);
  EXPECT_NEAR(picture->luma().data[5 * picture->luma().stride_bytes + 7], y_at(7, 5), 4);
  EXPECT_EQ(picture->chroma().data[0], 128);
}

TEST(MjpegDecoder, PaddingBehindThePictureDoesNotMatter) {
  auto jpeg = encode(TJSAMP_422);
  jpeg.resize(jpeg.size() + 1000, 0);
  EXPECT_TRUE(MjpegDecoder().decode(jpeg, kSize));
}

TEST(MjpegDecoder, WhatIsCutOffAnywhereIsNoPicture) {
  const auto jpeg = encode(TJSAMP_422);
  MjpegDecoder decoder;
  for (std::size_t bytes = 0; bytes < jpeg.size(); bytes += 7) {
    EXPECT_FALSE(decoder.decode({jpeg.data(), bytes}, kSize)) << bytes;
  }
  EXPECT_TRUE(decoder.decode(jpeg, kSize));  // and the next one is
}

TEST(MjpegDecoder, AnotherSizeIsNoPicture) {
  EXPECT_FALSE(MjpegDecoder().decode(encode(TJSAMP_420), {36, 23}));
}

TEST(MjpegDecoder, OtherBytesAreNoPicture) {
  std::vector<std::uint8_t> bytes(5000);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(i * i / 7 + i);
  }
  bytes.insert(bytes.end(), {0xFF, 0xD9});
  EXPECT_FALSE(MjpegDecoder().decode(bytes, kSize));
}

}  // namespace
}  // namespace gimbal
