#include "drivers/synthetic/street_scene.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "drivers/synthetic/picture_renderer.hpp"
#include "drivers/synthetic/world.hpp"

namespace gimbal {
namespace {

constexpr double kFocal_px = 300.0;
constexpr double kDegree = std::numbers::pi / 180.0;

VideoFrame look_at_street(double heading_rad, std::uint64_t seed) {
  const auto panorama = std::make_shared<Panorama>(
      std::make_shared<StreetScene>(seed, 1.0 / kFocal_px), kFocal_px, 2);
  VirtualCamera camera;
  camera.q_world_camera = Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()) *
                          Eigen::Quaterniond(level_R_world_camera());
  camera.intrinsics = {kFocal_px, kFocal_px, 159.5, 89.5};
  return render_global_shutter(panorama, camera, {320, 180});
}

int luma(const VideoFrame& frame, int x, int y) {
  return frame.planes[0].data[y * frame.planes[0].stride_bytes + x];
}

/// The smaller eigenvalue of the gradients' structure in a window: what corner trackers need to be
/// large (Shi and Tomasi, CVPR 1994).
double corner_strength(const VideoFrame& frame, int left, int top, int side) {
  Eigen::Matrix2d structure = Eigen::Matrix2d::Zero();
  for (int y = top + 1; y < top + side - 1; ++y) {
    for (int x = left + 1; x < left + side - 1; ++x) {
      const Eigen::Vector2d gradient(0.5 * (luma(frame, x + 1, y) - luma(frame, x - 1, y)),
                                     0.5 * (luma(frame, x, y + 1) - luma(frame, x, y - 1)));
      structure += gradient * gradient.transpose();
    }
  }
  const double trace = structure.trace();
  const double root = std::sqrt(trace * trace / 4 - structure.determinant());
  return (trace / 2 - root) / (side * side);
}

TEST(StreetScene, HasCornersToTrackWhereverOneLooks) {
  for (int heading = 0; heading < 360; heading += 45) {
    const VideoFrame frame = look_at_street(heading * kDegree, 1);
    int windows_with_corners = 0;
    for (int top = 0; top + 20 <= 180; top += 20) {
      for (int left = 0; left + 20 <= 320; left += 20) {
        windows_with_corners += corner_strength(frame, left, top, 20) > 10.0 ? 1 : 0;
      }
    }
    EXPECT_GT(windows_with_corners, 20) << heading;  // of 144, road and sky included
  }
}

TEST(StreetScene, TheHorizonIsLevel) {
  // Between houses' feet and the vanishing point nothing of the ground reaches above eye height.
  const StreetScene scene(1, 1e-3);
  const Eigen::Vector3d down_the_street(std::cos(-20 * kDegree), std::sin(-20 * kDegree), 0);
  const Eigen::Vector3d below =
      scene.color((down_the_street - Eigen::Vector3d(0, 0, 0.05)).normalized());
  const Eigen::Vector3d zenith = scene.color(Eigen::Vector3d(0.05, 0, 1).normalized());
  EXPECT_LT(below.maxCoeff(), 0.6);         // road, dark or painted
  EXPECT_GT(zenith.z(), zenith.x() - 0.1);  // sky or cloud
  EXPECT_GT(zenith.z(), 0.3);
}

TEST(StreetScene, AnotherSeedIsAnotherStreet) {
  const VideoFrame one = look_at_street(0, 1);
  const VideoFrame same = look_at_street(0, 1);
  const VideoFrame other = look_at_street(0, 2);
  int changed = 0;
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 320; ++x) {
      ASSERT_EQ(luma(one, x, y), luma(same, x, y));
      changed += std::abs(luma(one, x, y) - luma(other, x, y)) > 8 ? 1 : 0;
    }
  }
  EXPECT_GT(changed, 320 * 180 / 10);
}

TEST(StreetScene, LightIsWithinWhatASensorTakes) {
  const StreetScene scene(3, 2e-3);
  for (double heading = 0; heading < 360; heading += 1.7) {
    for (double elevation = -85; elevation < 90; elevation += 1.9) {
      const Eigen::Vector3d direction(std::cos(heading * kDegree) * std::cos(elevation * kDegree),
                                      std::sin(heading * kDegree) * std::cos(elevation * kDegree),
                                      std::sin(elevation * kDegree));
      const Eigen::Vector3d color = scene.color(direction);
      ASSERT_TRUE(color.allFinite()) << heading << ' ' << elevation;
      ASSERT_GE(color.minCoeff(), 0.0) << heading << ' ' << elevation;
      ASSERT_LE(color.maxCoeff(), 1.2) << heading << ' ' << elevation;
    }
  }
}

}  // namespace
}  // namespace gimbal
