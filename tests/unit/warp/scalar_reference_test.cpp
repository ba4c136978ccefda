// The CPU warper against the scalar reference: all borders, directions, sizes and instruction sets.

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdlib>
#include <numbers>
#include <random>

#include "pipeline/warp/warper.hpp"
#include "tests/support/scalar_warper.hpp"
#include "tests/unit/warp/warp_scene.hpp"

namespace gimbal::warp_scene {
namespace {

using Eigen::Vector2d;

/// Makes Highway choose among these instruction sets only, until it goes.
class OnlyTarget {
 public:
  explicit OnlyTarget(std::int64_t target) { hwy::SetSupportedTargetsForTest(target); }
  OnlyTarget(const OnlyTarget&) = delete;
  OnlyTarget& operator=(const OnlyTarget&) = delete;
  ~OnlyTarget() { hwy::SetSupportedTargetsForTest(0); }
};

/// A turn by `roll_rad` and a magnification by `zoom` about the middle, with the lines sheared as a
/// pan shears them.
WarpMesh turned_mesh(ImageSize source, ImageSize output, Border border, double roll_rad,
                     double zoom) {
  const Vector2d source_middle((source.width - 1) / 2.0, (source.height - 1) / 2.0);
  const Vector2d output_middle((output.width - 1) / 2.0, (output.height - 1) / 2.0);
  const Eigen::Rotation2D<double> turn(roll_rad);
  return mesh_of_map(source, output, border, [=](const Vector2d& at) {
    const Vector2d from_middle = at - source_middle;
    const Vector2d sheared = from_middle + Vector2d(0.03 * from_middle.y(), 0);
    return Vector2d(output_middle + zoom * (turn * sheared));
  });
}

/// Every pixel black or white by chance: the most that interpolation can be wrong by.
VideoFrame make_static(ImageSize size) {
  std::mt19937 generator(3);
  std::bernoulli_distribution white(0.5);
  Nv12Buffer picture(size);
  const ImageSize chroma = chroma_size(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      picture.luma().data[y * picture.luma().stride_bytes + x] = white(generator) ? 255 : 0;
    }
  }
  for (int y = 0; y < chroma.height; ++y) {
    for (int x = 0; x < 2 * chroma.width; ++x) {
      picture.chroma().data[y * picture.chroma().stride_bytes + x] = white(generator) ? 255 : 0;
    }
  }
  return std::move(picture).publish({}, {"", ChromaSiting::left});
}

constexpr Interpolation kBoth[] = {Interpolation::bilinear, Interpolation::bicubic};

void expect_as_reference(const VideoFrame& picture, const WarpMesh& mesh) {
  for (const Interpolation interpolation : kBoth) {
    const VideoFrame drawn = make_cpu_warper(1, interpolation)->warp(picture, mesh).value();
    EXPECT_LE(largest_difference(drawn, warp_by_scalars(picture, mesh, interpolation)), 1)
        << (interpolation == Interpolation::bicubic ? "bicubic" : "bilinear");
  }
}

constexpr double kDegree = std::numbers::pi / 180;

TEST(ScalarReference, EveryRollGivesItsPicture) {
  const ImageSize size{200, 120};
  const VideoFrame picture = make_static(size);
  for (const double roll_deg :
       {0.0, 0.5, 2.0, -2.0, 3.7, -5.0, 7.9, 12.0, 45.0, 90.0, 175.0, 180.0}) {
    for (const double zoom : {0.1, 0.4, 0.55, 0.82, 1.0, 1.15, 3.0}) {
      SCOPED_TRACE(testing::Message() << roll_deg << " degrees, zoom " << zoom);
      expect_as_reference(picture,
                          turned_mesh(size, size, Border::extend, roll_deg * kDegree, zoom));
    }
  }
}

TEST(ScalarReference, EveryBorderGivesItsPicture) {
  const ImageSize size{161, 97};
  const VideoFrame picture = make_picture(size, {"", ChromaSiting::center});
  for (const Border border : {Border::crop, Border::extend, Border::mirror, Border::black}) {
    for (const View view : {View::zoomed_in, View::zoomed_out}) {
      expect_as_reference(picture, shaky_mesh(size, size, border, view));
    }
  }
}

TEST(ScalarReference, EverySizeGivesItsPicture) {
  for (const ImageSize size : {ImageSize{1, 1},
                               {2, 3},
                               {15, 15},
                               {16, 16},
                               {17, 40},
                               {33, 16},
                               {64, 2},
                               {500, 16},
                               {1000, 3}}) {
    for (const ImageSize output : {size, ImageSize{37, 21}}) {
      SCOPED_TRACE(testing::Message() << size.width << "x" << size.height << " to " << output.width
                                      << "x" << output.height);
      const double zoom = 1.1 * output.width / size.width;
      expect_as_reference(make_static(size),
                          turned_mesh(size, output, Border::mirror, 2 * kDegree, zoom));
    }
  }
}

TEST(ScalarReference, EveryStrideGivesItsPicture) {
  const ImageSize size{321, 181};
  const VideoFrame picture = make_static(size);
  const WarpMesh mesh = shaky_mesh(size, size, Border::black, View::zoomed_in);
  for (const Interpolation interpolation : kBoth) {
    const VideoFrame expected = warp_by_scalars(picture, mesh, interpolation);
    for (const auto& [luma, chroma] : {std::pair{321, 322}, {333, 323}, {-400, -350}}) {
      const VideoFrame moved = with_strides(picture, luma, chroma);
      const VideoFrame drawn = make_cpu_warper(1, interpolation)->warp(moved, mesh).value();
      EXPECT_LE(largest_difference(drawn, expected), 1) << luma;
    }
  }
}

TEST(ScalarReference, MeshesOfAnyShapeGiveTheirPicture) {
  const ImageSize size{150, 90};
  const VideoFrame picture = make_picture(size, {"", ChromaSiting::left});
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> shift_px(-12, 12);
  for (int i = 0; i < 10; ++i) {
    // Cells are about 3 pixels: most triangles lie on others, and some are nearly lines.
    expect_as_reference(picture, mesh_of_map(size, size, Border::black, [&](const Vector2d& at) {
                          return Vector2d(at + Vector2d(shift_px(generator), shift_px(generator)));
                        }));
  }
}

TEST(ScalarReference, EveryInstructionSetGivesItsPicture) {
  const ImageSize size{320, 180};
  const VideoFrame picture = make_static(size);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    const OnlyTarget only(target);
    for (const double roll_deg : {1.0, -2.0, 6.0, 30.0, 180.0}) {
      SCOPED_TRACE(make_cpu_warper(1)->renderer() + ", degrees: " + std::to_string(roll_deg));
      for (const double zoom : {0.6, 1.0, 1.3}) {
        expect_as_reference(picture,
                            turned_mesh(size, size, Border::black, roll_deg * kDegree, zoom));
      }
    }
  }
}

TEST(ScalarReference, ThreadsDoNotChangeThePicture) {
  const ImageSize size{322, 402};
  const VideoFrame picture = make_static(size);
  const WarpMesh mesh = shaky_mesh(size, size, Border::black, View::zoomed_out);
  for (const Interpolation interpolation : kBoth) {
    const VideoFrame alone = make_cpu_warper(1, interpolation)->warp(picture, mesh).value();
    const auto together = make_cpu_warper(3, interpolation);
    for (int frame = 0; frame < 20; ++frame) {
      EXPECT_EQ(largest_difference(together->warp(picture, mesh).value(), alone), 0);
    }
  }
}

}  // namespace
}  // namespace gimbal::warp_scene
