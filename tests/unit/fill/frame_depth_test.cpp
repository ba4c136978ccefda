#include "pipeline/fill/frame_depth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace gimbal {
namespace {

constexpr ImageSize kSize{644, 357};  // cut cells on both sides
constexpr float kMost_px = 60;

/// A pinhole camera turned by that, seen by one that is not.
WarpMesh mesh_of(const Eigen::Quaterniond& q_virtual_camera, MeshDensity density) {
  LensParameters parameters;
  parameters.K << 600, 0, 321.5, 0, 600, 178, 0, 0, 1;
  VirtualCamera camera;
  camera.intrinsics = {600, 600, 321.5, 178};
  return build_warp_mesh(
      *Lens::create(parameters), kSize, ReadoutDirection::top_down,
      [&](double) { return q_virtual_camera; }, camera, kSize, Border::fill, density);
}

Eigen::Quaterniond turned(double yaw_rad, double pitch_rad, double roll_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()) *
                            Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitX()) *
                            Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()));
}

/// To the nearest side of the frame, whose image under a rotation is a quadrangle.
double exact_depth_px(const WarpMesh& corners, const Eigen::Vector2d& point) {
  const auto corner = [&](std::size_t i) { return corners.vertices[i].output_px.cast<double>(); };
  const Eigen::Vector2d polygon[] = {corner(0), corner(1), corner(3), corner(2)};  // clockwise
  double inside = std::numeric_limits<double>::infinity();
  double nearest = inside;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d from = polygon[i];
    const Eigen::Vector2d along = polygon[(i + 1) % 4] - from;
    const Eigen::Vector2d inward = Eigen::Vector2d(-along.y(), along.x()).normalized();
    inside = std::min(inside, inward.dot(point - from));
    const double share = std::clamp((point - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (from + share * along - point).norm());
  }
  return inside > 0 ? nearest : -nearest;
}

class FrameDepth : public ::testing::TestWithParam<Eigen::Vector3d> {};

TEST_P(FrameDepth, IsTheDistanceToTheEdge) {
  const Eigen::Quaterniond q = turned(GetParam().x(), GetParam().y(), GetParam().z());
  const WarpMesh corners = mesh_of(q, {1, 1});
  const CellGrid grid(kSize);
  const NodeField depth = frame_depth(mesh_of(q, {7, 5}), grid, kMost_px);
  for (int row = 0; row <= grid.rows(); ++row) {
    for (int column = 0; column <= grid.columns(); ++column) {
      const double exact = exact_depth_px(corners, {grid.node_x(column), grid.node_y(row)});
      EXPECT_NEAR(depth[grid.node_index({column, row})],
                  std::clamp<double>(exact, -kMost_px, kMost_px), 0.01)
          << column << ", " << row;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Turns, FrameDepth,
                         ::testing::Values(Eigen::Vector3d(0.05, 0.02, 0.03),
                                           Eigen::Vector3d(-0.2, 0.1, -0.3),
                                           Eigen::Vector3d(0, 0, 1.6),    // on its side
                                           Eigen::Vector3d(0.9, 0, 0)));  // elsewhere

}  // namespace
}  // namespace gimbal
