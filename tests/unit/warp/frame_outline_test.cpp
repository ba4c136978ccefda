#include "pipeline/warp/frame_outline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace gimbal {
namespace {

constexpr ImageSize kSize{640, 480};
constexpr PinholeIntrinsics kIntrinsics{600, 600, 319.5, 239.5};

Lens pinhole() {
  LensParameters parameters;
  parameters.K << 600, 0, 319.5, 0, 600, 239.5, 0, 0, 1;
  return *Lens::create(parameters);
}

const Lens kLens = pinhole();
const OutputProjection kProjection(OutputLens::rectilinear, kLens, kIntrinsics);

/// A camera that turns by `rate_rad` about `axis` while its rows are read.
LineOrientation turning(const Eigen::Vector3d& axis, double rate_rad) {
  return [axis, rate_rad](double line) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(rate_rad * line / kSize.height, axis));
  };
}

FrameOutline outline_of(const LineOrientation& motion) {
  return trace_outline(pinhole(), kSize, ReadoutDirection::top_down, motion, 25);
}

Eigen::Quaterniond turned(const Eigen::Vector3d& axis, double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis));
}

TEST(FrameOutline, AStillCameraNeedsNoZoom) {
  const auto outline = outline_of(turning(Eigen::Vector3d::UnitZ(), 0));
  const double zoom = required_zoom(outline, Eigen::Quaterniond::Identity(), kProjection, kSize);
  EXPECT_LE(zoom, 1);
  EXPECT_NEAR(zoom, 479.0 / 480, 1e-3);  // pixel centres end half a pixel inside the edge
}

TEST(FrameOutline, ARollNeedsWhatGeometrySays) {
  const auto outline = outline_of(turning(Eigen::Vector3d::UnitZ(), 0));
  constexpr double kAngle = 0.1;
  const double zoom =
      required_zoom(outline, turned(Eigen::Vector3d::UnitZ(), kAngle), kProjection, kSize);
  // The output's corner must not cross the frame's long side: cos + aspect * sin.
  EXPECT_NEAR(zoom, std::cos(kAngle) + 640.0 / 480 * std::sin(kAngle), 5e-3);
}

TEST(FrameOutline, AKeptLensNeedsNoZoomWhereStraightLinesDo) {
  LensParameters pincushion = pinhole().parameters();
  pincushion.model = LensModel::brown;
  pincushion.distortion = {0.15, 0, 0, 0};
  const Lens lens = *Lens::create(pincushion);
  const auto outline = trace_outline(lens, kSize, ReadoutDirection::top_down,
                                     turning(Eigen::Vector3d::UnitZ(), 0), 25);
  const auto zoom_for = [&](OutputLens output) {
    return required_zoom(outline, Eigen::Quaterniond::Identity(), {output, lens, kIntrinsics},
                         kSize);
  };
  EXPECT_NEAR(zoom_for(OutputLens::kept), 479.0 / 480, 1e-3);
  // The middle of a side, at r = 0.4 of the focal length, has moved inwards by so much at least.
  EXPECT_GT(zoom_for(OutputLens::rectilinear), 1.015);
}

TEST(FrameOutline, AViewThatLooksPastTheEdgeNeverFits) {
  const auto outline = outline_of(turning(Eigen::Vector3d::UnitZ(), 0));
  for (const double angle : {0.6, 3.0}) {
    EXPECT_TRUE(std::isinf(
        required_zoom(outline, turned(Eigen::Vector3d::UnitY(), angle), kProjection, kSize)));
  }
}

TEST(FrameOutline, AtTheRequiredZoomTheMeshHasNoBorderAndJustBelowItHas) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(-0.08, 0.08);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d axis = Eigen::Vector3d(angle(random), angle(random), angle(random));
    const LineOrientation motion = turning(axis.normalized(), angle(random));
    const Eigen::Quaterniond view = turned(Eigen::Vector3d::UnitX(), angle(random)) *
                                    turned(Eigen::Vector3d::UnitZ(), angle(random));
    const double zoom = required_zoom(outline_of(motion), view, kProjection, kSize);
    ASSERT_TRUE(std::isfinite(zoom));
    const auto border_px_at = [&](double z) {
      const VirtualCamera camera{{}, view, zoomed(kIntrinsics, kSize, z), OutputLens::rectilinear};
      return count_border_pixels(build_warp_mesh(pinhole(), kSize, ReadoutDirection::top_down,
                                                 motion, camera, kSize, Border::crop, {24, 24}));
    };
    EXPECT_EQ(border_px_at(zoom * 1.0005), 0) << i;
    EXPECT_GT(border_px_at(zoom * 0.99), 0) << i;
  }
}

}  // namespace
}  // namespace gimbal
