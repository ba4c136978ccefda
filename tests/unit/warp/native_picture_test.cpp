// Pictures as cameras lay them out: what the GPU makes of them has to be what the CPU's conversion
// to NV12 and the same warper show.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/pixels/nv12_frame.hpp"
#include "pipeline/warp/warper.hpp"
#include "tests/unit/warp/warp_scene.hpp"

namespace gimbal::warp_scene {
namespace {

constexpr std::array kFormats = {NativeFormat::i420, NativeFormat::yuyv, NativeFormat::uyvy,
                                 NativeFormat::rgb, NativeFormat::bgr};

class NativePictures : public testing::TestWithParam<GlesVersion> {
 protected:
  [[nodiscard]] static std::unique_ptr<Warper> make(
      ImageSize size, Interpolation interpolation = Interpolation::bilinear) {
    return make_gles_warper(size, size, {interpolation, GetParam()}).value();
  }
};

TEST_P(NativePictures, AreDrawnAsTheirConversionIs) {
  for (const ImageSize size :
       {ImageSize{322, 182}, ImageSize{101, 57}, ImageSize{3, 2}, ImageSize{1, 1}}) {
    const auto warper = make(size);
    const WarpMesh mesh = shaky_mesh(size, size, Border::crop, View::zoomed_out);
    for (const NativeFormat format : kFormats) {
      // Rows as GL takes them, rows that it cannot be told of, and rows that it can.
      for (const int padding : {0, 5, 60}) {
        const VideoFrame native = native_picture(format, size, padding);
        const VideoFrame drawn = warper->warp(native, mesh).value();
        const VideoFrame expected = warper->warp(as_nv12(native), mesh).value();
        EXPECT_FALSE(drawn.native);
        EXPECT_EQ(drawn.color.colorimetry, "bt709");
        EXPECT_LE(largest_difference(drawn, expected), 1)
            << name_of(format) << ", " << size.width << "x" << size.height << ", padding "
            << padding;
      }
    }
  }
}

TEST_P(NativePictures, OfYuvAreTheConversionBitForBit) {
  for (const ImageSize size : {ImageSize{1282, 22}, ImageSize{101, 57}}) {
    const auto warper = make(size);
    const WarpMesh mesh = mesh_of_map(size, size, Border::crop, same);
    for (const NativeFormat format : {NativeFormat::i420, NativeFormat::yuyv, NativeFormat::uyvy}) {
      const VideoFrame native = native_picture(format, size, 0);
      EXPECT_EQ(largest_difference(warper->warp(native, mesh).value(), as_nv12(native)), 0)
          << name_of(format) << ", " << size.width;
    }
  }
}

TEST_P(NativePictures, AreSharpToo) {
  const ImageSize size{101, 57};
  const auto warper = make(size, Interpolation::bicubic);
  const WarpMesh mesh = shaky_mesh(size, size, Border::mirror, View::zoomed_in);
  for (const NativeFormat format : kFormats) {
    const VideoFrame native = native_picture(format, size, 0);
    // Of RGB, the two may round to neighbouring levels, and the kernel's weights lie as much as 1.6
    // times further apart than their sum.
    const bool is_rounded = format == NativeFormat::rgb || format == NativeFormat::bgr;
    EXPECT_LE(largest_difference(warper->warp(native, mesh).value(),
                                 warper->warp(as_nv12(native), mesh).value()),
              is_rounded ? 2 : 1)
        << name_of(format);
  }
}

TEST_P(NativePictures, MayComeByTurns) {
  const ImageSize size{64, 36};
  const auto warper = make(size);
  const WarpMesh mesh = mesh_of_map(size, size, Border::crop, same);
  const VideoFrame nv12 = make_picture(size, {});
  for (const NativeFormat format : {NativeFormat::yuyv, NativeFormat::i420, NativeFormat::yuyv}) {
    const VideoFrame native = native_picture(format, size, 0);
    EXPECT_EQ(largest_difference(warper->warp(native, mesh).value(), as_nv12(native)), 0);
    EXPECT_EQ(largest_difference(warper->warp(nv12, mesh).value(), nv12), 0);
  }
}

TEST_P(NativePictures, AreCopiedAsTheyLie) {
  const ImageSize size{101, 57};
  const WarpMesh mesh = mesh_of_map(size, size, Border::crop, same);
  const auto copied_for = [&](NativeFormat format) {
    const auto warper = make(size);
    static_cast<void>(warper->warp(native_picture(format, size, 0), mesh).value());
    EXPECT_EQ(warper->transfers(), "in copied " + std::string(name_of(format)) + ", out copied");
    const std::int64_t out = 101 * 57 + 2 * 51 * 29;
    return warper->bytes_copied() - out;
  };
  EXPECT_EQ(copied_for(NativeFormat::i420), 101 * 57 + 2 * 51 * 29);
  EXPECT_EQ(copied_for(NativeFormat::yuyv), 4 * 51 * 57);
  EXPECT_EQ(copied_for(NativeFormat::uyvy), 4 * 51 * 57);
  EXPECT_EQ(copied_for(NativeFormat::rgb), 3 * 101 * 57);
  EXPECT_EQ(copied_for(NativeFormat::bgr), 3 * 101 * 57);
}

TEST_P(NativePictures, AreWantedOnGpusAndForTests) {
  const ImageSize size{64, 36};
  const auto warper = make(size);
  EXPECT_EQ(warper->takes_native_pictures(), !is_software_renderer(warper->renderer()));
  const auto always =
      make_gles_warper(size, size, {Interpolation::bilinear, GetParam(), DmaBufUse::always});
  EXPECT_TRUE((*always)->takes_native_pictures());
}

TEST_P(NativePictures, WithoutAPlaneAreRefused) {
  const ImageSize size{64, 36};
  const auto warper = make(size);
  const WarpMesh mesh = mesh_of_map(size, size, Border::crop, same);
  VideoFrame native = native_picture(NativeFormat::i420, size, 0);
  native.native->planes[2] = {};
  EXPECT_FALSE(warper->warp(native, mesh));
}

INSTANTIATE_TEST_SUITE_P(Versions, NativePictures,
                         testing::Values(GlesVersion::best, GlesVersion::gles2),
                         [](const auto& version) {
                           return version.param == GlesVersion::best ? "best" : "gles2";
                         });

TEST(NativePicturesOnTheCpu, AreDrawnAsTheirConversionIs) {
  const ImageSize size{101, 57};
  const auto warper = make_cpu_warper();
  EXPECT_FALSE(warper->takes_native_pictures());
  const WarpMesh mesh = shaky_mesh(size, size, Border::crop, View::zoomed_in);
  for (const NativeFormat format : kFormats) {
    const VideoFrame native = native_picture(format, size, 5);
    EXPECT_EQ(largest_difference(warper->warp(native, mesh).value(),
                                 warper->warp(as_nv12(native), mesh).value()),
              0)
        << name_of(format);
  }
}

}  // namespace
}  // namespace gimbal::warp_scene
