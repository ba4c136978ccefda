#include "drivers/libcamera/picture_layout.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace gimbal {
namespace {

using libcamera::ColorSpace;

TEST(ColorimetryOf, IsGStreamers) {
  EXPECT_EQ(colorimetry_of(ColorSpace::Rec709), "bt709");
  EXPECT_EQ(colorimetry_of(ColorSpace::Smpte170m), "bt601");
  EXPECT_EQ(colorimetry_of(ColorSpace::Rec2020), "2:6:5:7");
  EXPECT_EQ(colorimetry_of(ColorSpace::Raw), "");
  EXPECT_EQ(colorimetry_of(std::nullopt), "");
}

TEST(ColorOf, ConvertedRgbIsAsInJpeg) {
  const ColorInfo color = color_of(LibcameraLayout::rgb_bytes, ColorSpace::Raw);
  EXPECT_EQ(color.colorimetry, "1:4:7:1");
  EXPECT_EQ(color.chroma_siting, ChromaSiting::center);
}

TEST(ExtentsOf, AreThoseOfThePixelFormats) {
  const auto bytes = [](LibcameraLayout layout, std::ptrdiff_t stride) {
    std::vector<std::size_t> all;
    for (const PlaneExtent& extent : extents_of({{4, 4}, layout, stride, {}})) {
      all.push_back(extent.bytes);
    }
    return all;
  };
  EXPECT_EQ(bytes(LibcameraLayout::nv12, 4), (std::vector<std::size_t>{16, 8}));
  EXPECT_EQ(bytes(LibcameraLayout::yuv420, 8), (std::vector<std::size_t>{28, 6, 6}));
  EXPECT_EQ(bytes(LibcameraLayout::bgr_bytes, 12), (std::vector<std::size_t>{48}));
}

TEST(Converted, TheNamesOfDrmHaveTheirBytesTheOtherWayRound) {
  // DRM_FORMAT_RGB888 is [23:0] R:G:B little endian (drm_fourcc.h): blue comes first.
  const std::vector<std::uint8_t> blue = {255, 0, 0, 255, 0, 0};
  EXPECT_EQ(known_libcamera_formats()[2].format, libcamera::formats::RGB888);
  const auto layout = known_libcamera_formats()[2].layout;
  const auto picture = converted({{2, 1}, layout, 6, {}}, {{blue.data(), 6}});
  EXPECT_EQ(picture.luma().data[0], 29);  // 0.114 of 255
  EXPECT_EQ(picture.chroma().data[0], 255);
}

}  // namespace
}  // namespace gimbal
