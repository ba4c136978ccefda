#include "pipeline/warp/warp_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "tests/unit/warp/warp_scene.hpp"

namespace gimbal {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr ImageSize k720p{1280, 720};
constexpr double kDegree = std::numbers::pi / 180;

Quaterniond still(double) {
  return Quaterniond::Identity();
}

VirtualCamera camera_at(const Quaterniond& q_world_camera, const PinholeIntrinsics& intrinsics) {
  return {{}, q_world_camera, intrinsics};
}

Lens make_lens(LensModel model, double focal_px, std::vector<double> distortion) {
  LensParameters parameters;
  parameters.model = model;
  parameters.K << focal_px, 0, 650.4, 0, focal_px, 345.3, 0, 0, 1;
  parameters.distortion = std::move(distortion);
  return Lens::create(parameters).value();
}

std::vector<std::uint16_t> used_vertices(const WarpMesh& mesh) {
  std::vector<std::uint16_t> used = mesh.triangles;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  return used;
}

/// The exact map from source to output, by rotation matrices.
struct ExactWarp {
  const Lens& lens;
  LineOrientation q_world_camera;
  VirtualCamera camera;
  bool by_rows = true;

  [[nodiscard]] Vector2d output_of(const Vector2d& source_px) const {
    const double line = by_rows ? source_px.y() : source_px.x();
    const Matrix3d R_world_camera = q_world_camera(line).toRotationMatrix();
    const Matrix3d R_world_virtual = camera.q_world_camera.toRotationMatrix();
    const Vector3d seen =
        R_world_virtual.transpose() * R_world_camera * lens.unproject(source_px).value();
    const PinholeIntrinsics& k = camera.intrinsics;
    return {k.fx * seen.x() / seen.z() + k.cx, k.fy * seen.y() / seen.z() + k.cy};
  }
};

TEST(WarpMesh, StillCameraLeavesPixelsWhereTheyAre) {
  const Lens lens = warp_scene::ipod_lens(k720p);
  const VirtualCamera camera = camera_at(still(0), warp_scene::ipod_intrinsics(k720p));
  const WarpMesh mesh = build_warp_mesh(lens, k720p, ReadoutDirection::top_down, still, camera,
                                        k720p, Border::crop, {8, 6});
  ASSERT_EQ(mesh.vertex_columns, 9);
  ASSERT_EQ(mesh.vertex_rows, 7);
  ASSERT_EQ(mesh.vertices.size(), 63U);
  EXPECT_EQ(mesh.triangles.size(), 3U * 2 * 8 * 6);
  for (const MeshVertex& vertex : mesh.vertices) {
    EXPECT_LT((vertex.output_px - vertex.source_px).norm(), 1e-3F);
  }
}

TEST(WarpMesh, OutermostLinesLieOnTheEdgesOfTheFrame) {
  const ImageSize odd{641, 361};
  const Lens lens = warp_scene::ipod_lens(odd);
  const VirtualCamera camera = camera_at(still(0), warp_scene::ipod_intrinsics(odd));
  const WarpMesh mesh = build_warp_mesh(lens, odd, ReadoutDirection::top_down, still, camera, odd,
                                        Border::black, {7, 3});
  EXPECT_EQ(mesh.vertices.front().source_px, Eigen::Vector2f(-0.5F, -0.5F));
  EXPECT_EQ(mesh.vertices.back().source_px, Eigen::Vector2f(640.5F, 360.5F));
}

class WarpMeshReadout : public testing::TestWithParam<ReadoutDirection> {};

/// Thesis (2.29)-(2.32) as they stand there, for a rotation at a constant rate: from the
/// orientation at a line to the first line's, then to the reference line's, in quaternion products.
TEST_P(WarpMeshReadout, VerticesFollowTheThesis) {
  const bool by_rows =
      GetParam() == ReadoutDirection::top_down || GetParam() == ReadoutDirection::bottom_up;
  const double lines = by_rows ? k720p.height : k720p.width;
  const Lens lens = warp_scene::ipod_lens(k720p);
  const PinholeIntrinsics k = warp_scene::ipod_intrinsics(k720p);
  const Quaterniond q_world_first(AngleAxisd(0.4, Vector3d(0.2, -0.5, 0.9).normalized()));
  const Quaterniond q_first_last(AngleAxisd(0.3, Vector3d(0.6, 0.7, -0.4).normalized()));
  const auto q_first_line = [&](double line) {  // (2.29)
    return Quaterniond::Identity().slerp(line / lines, q_first_last);
  };
  const double reference_line = lines / 3;
  const WarpMesh mesh = build_warp_mesh(
      lens, k720p, GetParam(),
      [&](double line) { return q_world_first * q_first_line(std::max(line, 0.0)); },
      camera_at(q_world_first * q_first_line(reference_line), k), k720p, Border::crop, {10, 10});
  const Quaterniond q_reference_first = q_first_line(reference_line).conjugate();
  for (const MeshVertex& vertex : mesh.vertices) {
    const double x = vertex.source_px.x();
    const double y = vertex.source_px.y();
    const Quaterniond X(0, (x - k.cx) / k.fx, (y - k.cy) / k.fy, 1);
    const Quaterniond q = q_first_line(std::max(by_rows ? y : x, 0.0));
    const Quaterniond X_first =
        q * X * q.conjugate();  // (2.30), with q taking the line to the first
    const Quaterniond X_reference =
        q_reference_first * X_first * q_reference_first.conjugate();  // (2.32)
    const Vector2d expected(k.fx * X_reference.x() / X_reference.z() + k.cx,
                            k.fy * X_reference.y() / X_reference.z() + k.cy);
    EXPECT_LT((vertex.output_px.cast<double>() - expected).norm(), 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Directions, WarpMeshReadout,
                         testing::Values(ReadoutDirection::top_down, ReadoutDirection::bottom_up,
                                         ReadoutDirection::left_right,
                                         ReadoutDirection::right_left));

/// A camera that turns at 10 rad/s, faster by 50 rad/s² each second, while 720 lines are read in 30
/// ms.
Quaterniond violent_motion(double line) {
  const double t_s = (line / 720 - 0.5) * 0.030;
  const double angle_rad = 10 * t_s + 0.5 * 50 * t_s * t_s;
  return Quaterniond(AngleAxisd(angle_rad, Vector3d(0.5, 0.8, 0.33).normalized()));
}

/// The largest distance between the mesh and the exact map: an affine piece errs most in the middle
/// of its sides and of itself.
double largest_error_px(const WarpMesh& mesh, const ExactWarp& exact) {
  double largest = 0;
  const auto compare = [&](const std::vector<MeshVertex>& corners) {
    Vector2d source = Vector2d::Zero();
    Vector2d output = Vector2d::Zero();
    for (const MeshVertex& corner : corners) {
      source += corner.source_px.cast<double>() / static_cast<double>(corners.size());
      output += corner.output_px.cast<double>() / static_cast<double>(corners.size());
    }
    largest = std::max(largest, (exact.output_of(source) - output).norm());
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const MeshVertex& a = mesh.vertices[mesh.triangles[i]];
    const MeshVertex& b = mesh.vertices[mesh.triangles[i + 1]];
    const MeshVertex& c = mesh.vertices[mesh.triangles[i + 2]];
    for (const auto& corners :
         {std::vector{a, b}, std::vector{b, c}, std::vector{c, a}, std::vector{a, b, c}}) {
      compare(corners);
    }
  }
  return largest;
}

TEST(WarpMesh, DefaultDensityIsCloseToTheExactMapUnderViolentMotion) {
  struct Limit {
    Lens lens;
    double error_px;
  };
  const std::vector<Limit> limits = {
      {make_lens(LensModel::pinhole, 1223, {}), 0.1},
      {make_lens(LensModel::brown, 1223, {-0.25, 0.08, 1e-3, -1e-3}), 0.2},
      {make_lens(LensModel::fisheye, 1223, {0.05, -0.02, 0, 0}), 0.2}};
  for (const auto& [lens, limit_px] : limits) {
    for (const double turn_rad : {0.0, 0.1}) {
      const Quaterniond q_world_virtual(AngleAxisd(turn_rad, Vector3d(0.3, 1, 0.1).normalized()));
      const VirtualCamera camera = camera_at(q_world_virtual, {1223, 1223, 639.5, 359.5});
      const WarpMesh mesh = build_warp_mesh(lens, k720p, ReadoutDirection::top_down, violent_motion,
                                            camera, k720p, Border::crop, {});
      const double error_px = largest_error_px(mesh, {lens, violent_motion, camera});
      std::printf("lens model %d, turned by %.1f rad: at most %.3f px\n",
                  static_cast<int>(lens.parameters().model), turn_rad, error_px);
      EXPECT_LT(error_px, limit_px);
      EXPECT_GT(error_px, 1e-4) << "the motion does not test anything";
    }
  }
}

/// A hand's turn while 720 lines are read.
Quaterniond gentle_motion(double line) {
  const double readout = line / 720 - 0.5;
  return Quaterniond(AngleAxisd(0.03 * readout, Vector3d(0.5, 0.8, 0.33).normalized()));
}

struct MotionWithBound {
  LineOrientation q_world_camera;
  double bound_px;
};

TEST(WarpMesh, ChosenDensityIsWithinItsBoundAndNoFinerThanItMustBe) {
  for (const Lens& lens : {make_lens(LensModel::pinhole, 1223, {}),
                           make_lens(LensModel::brown, 1223, {-0.25, 0.08, 1e-3, -1e-3}),
                           make_lens(LensModel::fisheye, 1223, {0.05, -0.02, 0, 0})}) {
    for (const auto& [motion, bound_px] :
         {MotionWithBound{gentle_motion, 0.05}, MotionWithBound{violent_motion, 0.3}}) {
      for (const double turn_rad : {0.0, 0.1}) {
        const Quaterniond q_world_virtual(AngleAxisd(turn_rad, Vector3d(0.3, 1, 0.1).normalized()));
        const VirtualCamera camera = camera_at(q_world_virtual, {1400, 1400, 639.5, 359.5});
        const auto [density, promised_px] =
            choose_mesh_density(lens, k720p, ReadoutDirection::top_down, motion, camera, bound_px);
        const ExactWarp exact{lens, motion, camera};
        const auto error_px = [&](MeshDensity cells) {
          return largest_error_px(
              with_shared_error(build_warp_mesh(lens, k720p, ReadoutDirection::top_down, motion,
                                                camera, k720p, Border::crop, cells)),
              exact);
        };
        SCOPED_TRACE(testing::Message()
                     << "lens model " << static_cast<int>(lens.parameters().model) << ", turned by "
                     << turn_rad << " rad, cells: " << density.columns << " x " << density.rows);
        ASSERT_TRUE(promised_px);
        EXPECT_LE(*promised_px, bound_px);
        EXPECT_LT(error_px(density), *promised_px);
        EXPECT_GT(error_px({density.columns / 2, density.rows / 2}), bound_px);
      }
    }
  }
}

TEST(WarpMesh, SharedErrorIsAboutHalf) {
  for (const Lens& lens : {make_lens(LensModel::pinhole, 1223, {}),
                           make_lens(LensModel::brown, 1223, {-0.25, 0.08, 1e-3, -1e-3}),
                           make_lens(LensModel::fisheye, 1223, {0.05, -0.02, 0, 0})}) {
    for (const Border border : {Border::crop, Border::mirror}) {
      const Quaterniond q_world_virtual(AngleAxisd(0.1, Vector3d(0.3, 1, 0.1).normalized()));
      const VirtualCamera camera = camera_at(q_world_virtual, {1400, 1400, 639.5, 359.5});
      const WarpMesh mesh = build_warp_mesh(lens, k720p, ReadoutDirection::top_down, gentle_motion,
                                            camera, k720p, border, {12, 12});
      const WarpMesh shared = with_shared_error(mesh);
      const auto largest_inside_px = [&](WarpMesh part) {
        part.triangles.erase(part.triangles.begin(),  // cells of the ring come first
                             part.triangles.end() - std::ptrdiff_t{6} * 12 * 12);
        return largest_error_px(part, {lens, gentle_motion, camera});
      };
      EXPECT_GT(largest_inside_px(mesh), 0.02) << "nothing to share";
      EXPECT_LT(largest_inside_px(shared), 0.6 * largest_inside_px(mesh))
          << "lens model " << static_cast<int>(lens.parameters().model);
      EXPECT_EQ(shared.triangles, mesh.triangles);
    }
  }
}

TEST(WarpMesh, ErrorIsNotSharedWithWhatCannotBeSeen) {
  const Lens lens = make_lens(LensModel::pinhole, 600, {});
  const Quaterniond q_world_virtual(AngleAxisd(60 * kDegree, Vector3d::UnitY()));
  const WarpMesh mesh = build_warp_mesh(lens, k720p, ReadoutDirection::top_down, still,
                                        camera_at(q_world_virtual, {600, 600, 639.5, 359.5}), k720p,
                                        Border::crop, {20, 10});
  const WarpMesh shared = with_shared_error(mesh);
  ASSERT_LT(mesh.triangles.size(), 3U * 2 * 20 * 10);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_EQ(shared.vertices[i].output_px.allFinite(), mesh.vertices[i].output_px.allFinite());
  }
}

TEST(WarpMesh, ChosenDensityFollowsColumnsAsItFollowsRows) {
  const Lens lens = warp_scene::ipod_lens({720, 720});
  VirtualCamera camera = camera_at(still(0), warp_scene::ipod_intrinsics({720, 720}));
  const auto tremble = [](double line) {
    return Quaterniond(AngleAxisd(0.01 * std::sin(line / 60), Vector3d::UnitZ()));
  };
  const ImageSize square{720, 720};
  const MeshDensity by_rows =
      choose_mesh_density(lens, square, ReadoutDirection::top_down, tremble, camera).density;
  const MeshDensity by_columns =
      choose_mesh_density(lens, square, ReadoutDirection::left_right, tremble, camera).density;
  EXPECT_GT(by_rows.rows, 2 * by_rows.columns);
  EXPECT_GT(by_columns.columns, 2 * by_columns.rows);
}

TEST(WarpMesh, SourceThenExactMapReturnsToThePixel) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto random_vector = [&] {
    Vector3d vector;  // one by one: arguments may be drawn in any order
    for (double& element : vector) element = unit(generator);
    return vector;
  };
  const Lens lens = make_lens(LensModel::brown, 1223, {-0.2, 0.05, 1e-3, 0});
  int pixels = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const Vector3d rate_rad = 0.1 * random_vector();  // over the readout
    const Quaterniond q_start(AngleAxisd(3 * unit(generator), random_vector().normalized()));
    const auto pose = [&](double line) {
      const double angle_rad = rate_rad.norm() * (line / 720 - 0.5);
      return q_start * Quaterniond(AngleAxisd(angle_rad, rate_rad.normalized()));
    };
    const Quaterniond q_correction(AngleAxisd(0.1 * unit(generator), random_vector().normalized()));
    const VirtualCamera camera = camera_at(q_start * q_correction, {1300, 1300, 639.5, 359.5});
    const auto direction = ReadoutDirection::top_down;
    const auto chosen = choose_mesh_density(lens, k720p, direction, pose, camera);
    const WarpMesh mesh = with_shared_error(
        build_warp_mesh(lens, k720p, direction, pose, camera, k720p, Border::crop, chosen.density));
    const ExactWarp exact{lens, pose, camera};
    for (int i = 0; i < 40; ++i) {
      const Vector2d pixel(639.5 * (1 + unit(generator)), 359.5 * (1 + unit(generator)));
      const auto source = source_of(mesh, pixel);
      if (!source) continue;
      ++pixels;
      EXPECT_LT((exact.output_of(*source) - pixel).norm(), 0.1) << "trial " << trial;
    }
  }
  EXPECT_GT(pixels, 800);
}

TEST(WarpMesh, LeavesOutWhatIsBehindTheVirtualCamera) {
  const Lens lens = make_lens(LensModel::pinhole, 600, {});
  const PinholeIntrinsics k{600, 600, 639.5, 359.5};
  const auto turned_by = [&](double degrees) {
    const Quaterniond q_world_virtual(AngleAxisd(degrees * kDegree, Vector3d::UnitY()));
    return build_warp_mesh(lens, k720p, ReadoutDirection::top_down, still,
                           camera_at(q_world_virtual, k), k720p, Border::crop, {20, 10});
  };
  const WarpMesh partly = turned_by(60);  // the frame reaches to 46 degrees on each side
  EXPECT_GT(partly.triangles.size(), 3U * 20);
  EXPECT_LT(partly.triangles.size(), 3U * 2 * 20 * 10);
  for (const std::uint16_t vertex : used_vertices(partly)) {
    EXPECT_TRUE(partly.vertices[vertex].output_px.allFinite());
  }
  EXPECT_TRUE(turned_by(180).triangles.empty());
  EXPECT_EQ(count_border_pixels(turned_by(180)), 1280 * 720);
}

class WarpMeshRing : public testing::TestWithParam<Border> {};

TEST_P(WarpMeshRing, ReachesOneFrameBeyondTheEdges) {
  const Lens lens = warp_scene::ipod_lens(k720p);
  const VirtualCamera camera = camera_at(still(0), warp_scene::ipod_intrinsics(k720p));
  double lowest = 0;
  double highest = 0;
  const auto pose = [&](double line) {
    lowest = std::min(lowest, line);
    highest = std::max(highest, line);
    return Quaterniond::Identity();
  };
  const WarpMesh mesh = build_warp_mesh(lens, k720p, ReadoutDirection::top_down, pose, camera,
                                        k720p, GetParam(), {8, 6});
  EXPECT_EQ(mesh.vertex_columns, 11);
  EXPECT_EQ(mesh.vertex_rows, 9);
  EXPECT_EQ(mesh.vertices.front().source_px, Eigen::Vector2f(-1280.5F, -720.5F));
  EXPECT_EQ(mesh.vertices.back().source_px, Eigen::Vector2f(2559.5F, 1439.5F));
  EXPECT_EQ(lowest, -0.5) << "lines outside of the frame were never exposed";
  EXPECT_EQ(highest, 719.5);
  EXPECT_TRUE(source_of(mesh, {-1000, 1200}).has_value());
  EXPECT_EQ(count_border_pixels(mesh), 0);
}

TEST_P(WarpMeshRing, IsNarrowerWhereTheVirtualCameraCannotSeeThatFar) {
  const Lens lens = make_lens(LensModel::pinhole, 600, {});
  const Quaterniond q_world_virtual(AngleAxisd(15 * kDegree, Vector3d::UnitY()));
  const WarpMesh mesh = build_warp_mesh(lens, k720p, ReadoutDirection::top_down, still,
                                        camera_at(q_world_virtual, {600, 600, 639.5, 359.5}), k720p,
                                        GetParam(), {8, 6});
  EXPECT_EQ(mesh.triangles.size(), 3U * 2 * 10 * 8);
  EXPECT_GT(mesh.vertices.front().source_px.x(), -1280.5F);
  EXPECT_TRUE(source_of(mesh, {1270, 360}).has_value()) << "this pixel looks past the right edge";
}

/// A lens whose model folds back not far outside of the frame has no ray for a far ring.
TEST_P(WarpMeshRing, IsNarrowerWhereTheLensModelEnds) {
  const Lens lens = make_lens(LensModel::brown, 1223, {-0.3, 0, 0, 0});
  ASSERT_FALSE(lens.unproject({-1280, -720})) << "this lens does not test anything";
  const WarpMesh mesh =
      build_warp_mesh(lens, k720p, ReadoutDirection::top_down, still,
                      camera_at(still(0), {900, 900, 639.5, 359.5}), k720p, GetParam(), {8, 6});
  EXPECT_EQ(mesh.triangles.size(), 3U * 2 * 10 * 8);
}

INSTANTIATE_TEST_SUITE_P(Borders, WarpMeshRing, testing::Values(Border::extend, Border::mirror));

TEST(WarpMesh, DensityIsHeldWithinSixteenBitIndices) {
  const Lens lens = warp_scene::ipod_lens(k720p);
  const VirtualCamera camera = camera_at(still(0), warp_scene::ipod_intrinsics(k720p));
  const auto with_density = [&](MeshDensity density) {
    return build_warp_mesh(lens, k720p, ReadoutDirection::top_down, still, camera, k720p,
                           Border::mirror, density);
  };
  const WarpMesh densest = with_density({10000, 10000});
  EXPECT_LE(densest.vertices.size(), 65536U);
  EXPECT_EQ(used_vertices(densest).size(), densest.vertices.size());
  EXPECT_EQ(with_density({0, -3}).vertices.size(), 16U);
}

}  // namespace
}  // namespace gimbal
