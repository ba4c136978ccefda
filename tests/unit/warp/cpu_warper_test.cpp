// The CPU warper against what pictures must look like, pixel by pixel.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "pipeline/warp/warper.hpp"
#include "tests/unit/warp/warp_scene.hpp"

namespace gimbal::warp_scene {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;

VideoFrame warp_on_cpu(const VideoFrame& source, const WarpMesh& mesh) {
  return make_cpu_warper()->warp(source, mesh).value();
}

std::uint8_t luma_at(const VideoFrame& frame, int x, int y) {
  return frame.planes[0].data[y * frame.planes[0].stride_bytes + x];
}

std::uint8_t chroma_at(const VideoFrame& frame, int x, int y, int channel) {
  return frame.planes[1].data[y * frame.planes[1].stride_bytes + 2 * x + channel];
}

class CpuWarperSizes : public testing::TestWithParam<ImageSize> {};

TEST_P(CpuWarperSizes, IdentityIsBitForBit) {
  for (const ChromaSiting siting : {ChromaSiting::left, ChromaSiting::center}) {
    const VideoFrame picture = make_picture(GetParam(), {"", siting});
    for (const Border border : {Border::crop, Border::extend, Border::mirror, Border::black}) {
      const WarpMesh mesh = mesh_of_map(GetParam(), GetParam(), border, same);
      for (const Interpolation interpolation : {Interpolation::bilinear, Interpolation::bicubic}) {
        const VideoFrame drawn = make_cpu_warper({}, interpolation)->warp(picture, mesh).value();
        EXPECT_EQ(plane_bytes(drawn, 0), plane_bytes(picture, 0));
        EXPECT_EQ(plane_bytes(drawn, 1), plane_bytes(picture, 1));
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, CpuWarperSizes,
                         testing::Values(ImageSize{480, 360}, ImageSize{641, 361},
                                         ImageSize{640, 361}, ImageSize{641, 360}, ImageSize{1, 1},
                                         ImageSize{2, 2}, ImageSize{3, 5}));

TEST(CpuWarper, TakesAnyStride) {
  const ImageSize size{321, 181};
  const VideoFrame picture = make_picture(size, {});
  const WarpMesh mesh = shaky_mesh(size, size, Border::crop, View::zoomed_in);
  const VideoFrame expected = warp_on_cpu(picture, mesh);
  for (const auto& [luma, chroma] : {std::pair{321, 322}, {333, 323}, {-400, -350}}) {
    const VideoFrame drawn = warp_on_cpu(with_strides(picture, luma, chroma), mesh);
    EXPECT_EQ(plane_bytes(drawn, 0), plane_bytes(expected, 0)) << luma;
    EXPECT_EQ(plane_bytes(drawn, 1), plane_bytes(expected, 1)) << chroma;
  }
}

TEST(CpuWarper, WholeShiftsAreExactAndLeaveBlackBehind) {
  const ImageSize size{200, 120};
  const VideoFrame picture = make_picture(size, {});
  const int right = 6;
  const int up = 4;
  const VideoFrame drawn =
      warp_on_cpu(picture, mesh_of_map(size, size, Border::black, [&](const Vector2d& source) {
                    return Vector2d(source + Vector2d(right, -up));
                  }));
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const bool covered = x >= right && y + up < size.height;
      ASSERT_EQ(luma_at(drawn, x, y), covered ? luma_at(picture, x - right, y + up) : 16)
          << x << ", " << y;
    }
  }
  for (int y = 0; y < size.height / 2; ++y) {
    for (int x = 0; x < size.width / 2; ++x) {
      const bool covered = x >= right / 2 && y + up / 2 < size.height / 2;
      const bool beside = x == right / 2 - 1 || y + up / 2 == size.height / 2;
      if (beside) continue;  // chroma is drawn out by a pixel of luma
      for (int channel = 0; channel < 2; ++channel) {
        const int expected = covered ? chroma_at(picture, x - right / 2, y + up / 2, channel) : 128;
        ASSERT_EQ(chroma_at(drawn, x, y, channel), expected) << x << ", " << y;
      }
    }
  }
}

TEST(CpuWarper, QuarterTurnIsAnExactTransposition) {
  const ImageSize size{160, 90};
  const ImageSize turned_size{90, 160};
  // With chroma in the middle of its block, turning takes chroma samples to chroma samples.
  const VideoFrame picture = make_picture(size, {"", ChromaSiting::center});
  const VideoFrame turned =
      warp_on_cpu(picture, mesh_of_map(size, turned_size, Border::crop, [](const Vector2d& source) {
                    return Vector2d(89 - source.y(), source.x());
                  }));
  for (int y = 0; y < turned_size.height; ++y) {
    for (int x = 0; x < turned_size.width; ++x) {
      ASSERT_EQ(luma_at(turned, x, y), luma_at(picture, y, 89 - x)) << x << ", " << y;
      ASSERT_EQ(chroma_at(turned, x / 2, y / 2, 0), chroma_at(picture, y / 2, 44 - x / 2, 0));
      ASSERT_EQ(chroma_at(turned, x / 2, y / 2, 1), chroma_at(picture, y / 2, 44 - x / 2, 1));
    }
  }
}

/// A turn by the camera itself, for the same result through lens, rotation and projection.
TEST(CpuWarper, RolledCameraGivesTheTurnedPicture) {
  const ImageSize size{160, 160};
  LensParameters parameters;
  parameters.K << 150, 0, 79.5, 0, 150, 79.5, 0, 0, 1;
  VirtualCamera camera;
  camera.intrinsics = {150, 150, 79.5, 79.5};
  camera.q_world_camera = Eigen::AngleAxisd(-std::acos(0.0), Eigen::Vector3d::UnitZ());
  const WarpMesh mesh = build_warp_mesh(
      Lens::create(parameters).value(), size, ReadoutDirection::top_down,
      [](double) { return Eigen::Quaterniond::Identity(); }, camera, size, Border::crop, {});
  const VideoFrame picture = make_picture(size, {});
  const VideoFrame drawn = warp_on_cpu(picture, mesh);
  EXPECT_EQ(count_border_pixels(mesh), 0);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      // Camera turned counter-clockwise, picture content clockwise: up in the source is right here.
      ASSERT_EQ(luma_at(drawn, x, y), luma_at(picture, y, 159 - x)) << x << ", " << y;
    }
  }
}

int clamped(int i, int length) {
  return i < 0 ? 0 : (i >= length ? length - 1 : i);
}

/// Where a mirror image continues: ... 1 0 | 0 1 2 | 2 1 ...
int mirrored(int i, int length) {
  while (i < 0 || i >= length) i = i < 0 ? -1 - i : 2 * length - 1 - i;
  return i;
}

/// Bilinear interpolation in floating point, of a plane with `channels` bytes a pixel.
double bilinear(const ConstPlane& plane, ImageSize size, int channels, int channel, Border border,
                const Vector2d& at) {
  const auto pixel = [&](int x, int y) -> double {
    const auto index = border == Border::mirror ? mirrored : clamped;
    return plane.data[index(y, size.height) * plane.stride_bytes + index(x, size.width) * channels +
                      channel];
  };
  const int x = static_cast<int>(std::floor(at.x()));
  const int y = static_cast<int>(std::floor(at.y()));
  const double right = at.x() - x;
  const double down = at.y() - y;
  return (1 - down) * ((1 - right) * pixel(x, y) + right * pixel(x + 1, y)) +
         down * ((1 - right) * pixel(x, y + 1) + right * pixel(x + 1, y + 1));
}

struct Look {
  Border border;
  View view;
  ChromaSiting siting;
};

class CpuWarperLooks : public testing::TestWithParam<Look> {};

TEST_P(CpuWarperLooks, EveryPixelIsTheBilinearSampleOfItsSource) {
  const auto [border, view, siting] = GetParam();
  const ImageSize source_size{241, 135};
  // Large enough that nothing shrinks: then each pixel is one sample.
  const ImageSize output_size =
      view == View::zoomed_out ? ImageSize{401, 225} : ImageSize{200, 113};
  const VideoFrame picture = make_picture(source_size, {"", siting});
  const WarpMesh mesh = shaky_mesh(source_size, output_size, border, view);
  const VideoFrame drawn = warp_on_cpu(picture, mesh);
  int covered = 0;
  for (int y = 0; y < output_size.height; ++y) {
    for (int x = 0; x < output_size.width; ++x) {
      const auto source = source_of(mesh, Vector2d(x, y));
      const double expected =
          source ? bilinear(picture.planes[0], source_size, 1, 0, border, *source) : 16.0;
      ASSERT_NEAR(luma_at(drawn, x, y), expected, 0.8) << x << ", " << y;
      covered += source ? 1 : 0;
    }
  }
  EXPECT_GT(covered, output_size.width * output_size.height / 5);

  // A chroma sample (i, j) lies at (2i, 2j + 1/2) of luma, or at (2i + 1/2, 2j + 1/2).
  const Vector2d first(siting == ChromaSiting::left ? 0 : 0.5, 0.5);
  const ImageSize chroma = chroma_size(output_size);
  int compared = 0;
  for (int j = 0; j < chroma.height; ++j) {
    for (int i = 0; i < chroma.width; ++i) {
      const auto source = source_of(mesh, 2.0 * Vector2d(i, j) + first);
      if (!source) continue;
      ++compared;
      const Vector2d at = (*source - first) / 2;
      for (int channel = 0; channel < 2; ++channel) {
        const double expected =
            bilinear(picture.planes[1], chroma_size(source_size), 2, channel, border, at);
        // Cells at the outline are drawn out for chroma, which bends their map by a few hundredths.
        ASSERT_NEAR(chroma_at(drawn, i, j, channel), expected, 4.0) << i << ", " << j;
      }
    }
  }
  EXPECT_GT(compared, chroma.width * chroma.height / 5);
}

INSTANTIATE_TEST_SUITE_P(
    Looks, CpuWarperLooks,
    testing::Values(Look{Border::crop, View::zoomed_in, ChromaSiting::left},
                    Look{Border::black, View::zoomed_out, ChromaSiting::center},
                    Look{Border::extend, View::zoomed_out, ChromaSiting::left},
                    Look{Border::mirror, View::zoomed_out, ChromaSiting::left},
                    Look{Border::mirror, View::zoomed_in, ChromaSiting::center}));

TEST(CpuWarper, ChromaIsDrawnWhereverLumaIs) {
  // An odd picture's last chroma sample lies beyond the last centre of luma.
  const ImageSize size{33, 17};
  const VideoFrame picture = make_picture(size, {"", ChromaSiting::center});
  for (const double scale : {1.0, 0.5, 1.3}) {
    const ImageSize output{static_cast<int>(std::lround(33 * scale)) | 1,
                           static_cast<int>(std::lround(17 * scale)) | 1};
    const Vector2d stretch((output.width + 0.02) / size.width,
                           (output.height + 0.02) / size.height);
    const WarpMesh mesh = mesh_of_map(size, output, Border::black, [&](const Vector2d& source) {
      return Vector2d(((source.array() + 0.5) * stretch.array() - 0.51).matrix());
    });
    ASSERT_EQ(count_border_pixels(mesh), 0);
    VideoFrame grey = picture;
    std::vector<std::uint8_t> colour(64 * 9, 200);  // nowhere 128
    grey.planes[1] = {colour.data(), 64};
    const std::vector<std::uint8_t> drawn = plane_bytes(warp_on_cpu(grey, mesh), 1);
    EXPECT_EQ(drawn, std::vector<std::uint8_t>(drawn.size(), 200)) << "scale " << scale;
  }
}

TEST(CpuWarper, BlackFollowsTheRangeOfTheColour) {
  const ImageSize size{64, 32};
  const auto luma_of_nothing = [&](const std::string& colorimetry) {
    const WarpMesh elsewhere = mesh_of_map(size, size, Border::black, [](const Vector2d& source) {
      return Vector2d(source + Vector2d(1000, 0));
    });
    const VideoFrame drawn = warp_on_cpu(make_picture(size, {colorimetry, {}}), elsewhere);
    EXPECT_EQ(plane_bytes(drawn, 1), std::vector<std::uint8_t>(64 * 16, 128));
    return luma_at(drawn, 5, 5);
  };
  EXPECT_EQ(luma_of_nothing(""), 16);
  EXPECT_EQ(luma_of_nothing("bt709"), 16);
  EXPECT_EQ(luma_of_nothing("2:4:16:3"), 16);
  EXPECT_EQ(luma_of_nothing("1:4:0:0"), 0);
}

TEST(CpuWarper, StampAndColourGoThrough) {
  const ImageSize size{64, 32};
  const VideoFrame picture = make_picture(size, {"bt601", ChromaSiting::center});
  const VideoFrame drawn = warp_on_cpu(picture, mesh_of_map(size, size, Border::crop, same));
  EXPECT_EQ(drawn.stamp.index, picture.stamp.index);
  EXPECT_EQ(drawn.stamp.time, picture.stamp.time);
  EXPECT_EQ(drawn.color.colorimetry, "bt601");
  EXPECT_EQ(drawn.color.chroma_siting, ChromaSiting::center);
}

TEST(CpuWarper, FramesThatAreHeldAreNotDrawnOver) {
  const ImageSize size{64, 32};
  const auto warper = make_cpu_warper();
  const WarpMesh mesh = mesh_of_map(size, size, Border::crop, same);
  const VideoFrame picture = make_picture(size, {});
  std::optional<VideoFrame> first = warper->warp(picture, mesh).value();
  VideoFrame black = picture;
  const std::vector<std::uint8_t> zeros(64 * 32);
  black.planes = {{{zeros.data(), 64}, {zeros.data(), 64}}};
  const VideoFrame second = warper->warp(black, mesh).value();
  EXPECT_NE(first->planes[0].data, second.planes[0].data);
  EXPECT_EQ(plane_bytes(*first, 0), plane_bytes(picture, 0));
  const std::uint8_t* memory = first->planes[0].data;
  first.reset();
  EXPECT_EQ(warper->warp(black, mesh).value().planes[0].data, memory) << "memory is used again";
}

TEST(CpuWarper, FramesOutliveTheWarper) {
  const ImageSize size{64, 32};
  const VideoFrame picture = make_picture(size, {});
  auto warper = make_cpu_warper();
  const VideoFrame drawn =
      warper->warp(picture, mesh_of_map(size, size, Border::crop, same)).value();
  warper.reset();
  EXPECT_EQ(plane_bytes(drawn, 0), plane_bytes(picture, 0));
}

TEST(CpuWarper, RefusesAMeshMadeForAnotherFrame) {
  const WarpMesh mesh = mesh_of_map({32, 32}, {32, 32}, Border::crop, same);
  const auto drawn = make_cpu_warper()->warp(make_picture({64, 32}, {}), mesh);
  ASSERT_FALSE(drawn);
  EXPECT_EQ(drawn.error().kind, Error::Kind::failed);
  EXPECT_THAT(drawn.error().message, HasSubstr("frame 7 is 64x32"));
  EXPECT_THAT(drawn.error().message, HasSubstr("32x32"));
}

TEST(CpuWarper, RefusesAFrameOrAMeshWithNothingInIt) {
  const auto warper = make_cpu_warper();
  EXPECT_FALSE(warper->warp(VideoFrame{}, mesh_of_map({32, 32}, {32, 32}, Border::crop, same)));
  WarpMesh nothing;
  nothing.source_size = {32, 32};
  EXPECT_FALSE(warper->warp(make_picture({32, 32}, {}), nothing));
}

}  // namespace
}  // namespace gimbal::warp_scene
