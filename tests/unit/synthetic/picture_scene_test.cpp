#include "drivers/synthetic/picture_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace gimbal {
namespace {

/// One colour everywhere, and a luma of its own at (x, y).
VideoFrame picture(ImageSize size, std::array<std::uint8_t, 3> yuv, const std::string& colorimetry,
                   int x, int y, std::uint8_t spot) {
  Nv12Buffer buffer(size);
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      buffer.luma().data[row * buffer.luma().stride_bytes + column] = yuv[0];
    }
  }
  const ImageSize chroma = chroma_size(size);
  for (int row = 0; row < chroma.height; ++row) {
    for (int column = 0; column < chroma.width; ++column) {
      std::uint8_t* pair = buffer.chroma().data + row * buffer.chroma().stride_bytes + 2 * column;
      pair[0] = yuv[1];
      pair[1] = yuv[2];
    }
  }
  buffer.luma().data[y * buffer.luma().stride_bytes + x] = spot;
  return std::move(buffer).publish({}, {colorimetry, ChromaSiting::left});
}

TEST(PictureScene, ItsMiddleLiesAheadAndItsLeftToTheLeft) {
  // 101 pixels over 1.01 rad: a pixel is 10 mrad. The spot is 20 right of and 7 above the middle.
  const PictureScene scene(picture({101, 51}, {16, 128, 128}, "bt709", 70, 18, 235), 1.01);
  const double heading = -0.20;
  const double elevation = 0.07;
  const Eigen::Vector3d spot(std::cos(heading) * std::cos(elevation),
                             std::sin(heading) * std::cos(elevation), std::sin(elevation));
  EXPECT_NEAR(scene.color(spot).x(), 1.0, 1e-6);
  EXPECT_NEAR(scene.color(Eigen::Vector3d(1, 0, 0)).x(), 0.0, 1e-6);
  const Eigen::Vector3d mirrored(spot.x(), -spot.y(), spot.z());
  EXPECT_NEAR(scene.color(mirrored).x(), 0.0, 1e-6);
}

TEST(PictureScene, IsMirroredPastItsEdges) {
  const PictureScene scene(picture({101, 51}, {16, 128, 128}, "bt709", 100, 25, 235), 1.01);
  const auto at_heading = [&](double heading) {
    return scene.color({std::cos(heading), std::sin(heading), 0}).x();
  };
  EXPECT_NEAR(at_heading(-0.50), 1.0, 1e-6);  // the last column's centre
  EXPECT_NEAR(at_heading(-0.51), 1.0, 1e-6);  // and its image beyond the edge at 0.505
  EXPECT_NEAR(at_heading(-0.53), 0.0, 1e-6);
}

TEST(PictureScene, DecodesBothWaysOfWritingColour) {
  // Red by the definitions of BT.709 at video range and of JFIF, rounded to bytes.
  for (const auto& [yuv, colorimetry] :
       {std::pair{std::array<std::uint8_t, 3>{63, 102, 240}, "bt709"},
        std::pair{std::array<std::uint8_t, 3>{76, 85, 255}, "1:4:0:0"}}) {
    const PictureScene scene(picture({16, 16}, yuv, colorimetry, 0, 0, yuv[0]), 1.0);
    const Eigen::Vector3d color = scene.color({1, 0, 0});
    EXPECT_NEAR(color.x(), 1.0, 0.02) << colorimetry;
    EXPECT_NEAR(color.y(), 0.0, 0.01) << colorimetry;
    EXPECT_NEAR(color.z(), 0.0, 0.01) << colorimetry;
  }
}

TEST(PictureScene, CoversAllDirectionsEvenWithOnePixel) {
  const PictureScene scene(picture({1, 1}, {126, 128, 128}, "bt709", 0, 0, 126), 1.0);
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, 0, 1),
        Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0, 0, -1)}) {
    EXPECT_NEAR(scene.color(direction).x(), 0.26, 0.01);
  }
}

}  // namespace
}  // namespace gimbal
