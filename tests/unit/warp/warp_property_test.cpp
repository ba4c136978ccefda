// Random lenses, motions and directions: the map of a mesh against its exact inverse.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "pipeline/warp/output_projection.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// A picture, its lens and a hand's motion, all by chance.
class RandomScene {
 public:
  explicit RandomScene(unsigned seed)
      : generator_(seed),
        size{whole(16, 1280), whole(16, 720)},
        direction(static_cast<ReadoutDirection>(whole(0, 3))),
        lens(random_lens()) {
    const bool keeps = whole(0, 1) == 1;
    const Quaterniond q_start = turned(3);
    const double lines = line_count(size, direction);
    // Over the readout. Slow enough that no line overtakes the next: then there is an inverse.
    const double most_rad = std::min(0.05, 0.25 * lines / lens.parameters().K(0, 0));
    const Vector3d rate_rad = most_rad * vector();
    q_world_camera = [=](double line) {
      return q_start *
             Quaterniond(AngleAxisd(rate_rad.norm() * (line / lines - 0.5), rate_rad.normalized()));
    };
    camera.q_world_camera = q_start * turned(0.15);
    camera.lens = keeps ? OutputLens::kept : OutputLens::rectilinear;
    camera.intrinsics = output_intrinsics(lens.parameters(), size, std::nullopt);
    camera.intrinsics.fx *= 1 + 0.3 * unit();
    camera.intrinsics.fy = camera.intrinsics.fx;
  }

  [[nodiscard]] Vector2d point_of_picture() {
    return {size.width * (0.5 + 0.5 * unit()) - 0.5, size.height * (0.5 + 0.5 * unit()) - 0.5};
  }

  /// The exact map, from its definition.
  [[nodiscard]] std::optional<Vector2d> output_of(const Vector2d& source_px) const {
    const auto ray = lens.unproject(source_px);
    if (!ray) return std::nullopt;
    const OutputProjection projection(camera.lens, lens, camera.intrinsics);
    return projection.pixel_of(camera.q_world_camera.conjugate() *
                               (q_world_camera(line_of(source_px)) * *ray));
  }

  /// Its exact inverse: the line that a point was exposed in follows from where it lies, so that
  /// both are found in turns.
  [[nodiscard]] std::optional<Vector2d> source_of_exactly(const Vector2d& output_px) const {
    const Lens virtual_lens = lens_of_output();
    const auto seen = virtual_lens.unproject(output_px);
    if (!seen) return std::nullopt;
    const Vector3d ray_world = camera.q_world_camera * *seen;
    std::optional<Vector2d> source(Vector2d(size.width / 2.0, size.height / 2.0));
    for (int i = 0; i < 40 && source; ++i) {
      source = lens.project(q_world_camera(line_of(*source)).conjugate() * ray_world);
    }
    return source;
  }

 private:
  // Before what it makes.
  std::mt19937 generator_;

 public:
  ImageSize size;
  ReadoutDirection direction;
  Lens lens;
  LineOrientation q_world_camera;
  VirtualCamera camera;

 private:
  [[nodiscard]] double line_of(const Vector2d& px) const {
    return reads_rows(direction) ? px.y() : px.x();
  }
  [[nodiscard]] Lens lens_of_output() const {
    LensParameters parameters;
    if (camera.lens == OutputLens::kept) parameters = lens.parameters();
    const PinholeIntrinsics& k = camera.intrinsics;
    parameters.K << k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1;
    return Lens::create(parameters).value();
  }
  int whole(int least, int most) {
    return std::uniform_int_distribution<int>(least, most)(generator_);
  }
  double unit() { return std::uniform_real_distribution<double>(-1, 1)(generator_); }
  Vector3d vector() {
    const double x = unit();
    const double y = unit();
    return {x, y, unit()};
  }
  Quaterniond turned(double most_rad) {
    const double angle = most_rad * unit();
    return Quaterniond(AngleAxisd(angle, vector().normalized()));
  }

  Lens random_lens() {
    LensParameters parameters;
    parameters.model = static_cast<LensModel>(whole(0, 2));
    const double side = std::max(size.width, size.height);
    const double focal = side * (0.9 + 0.3 * unit());
    parameters.K << focal, 0, size.width / 2.0 + 0.02 * side * unit(), 0,
        focal * (1 + 0.02 * unit()), size.height / 2.0 + 0.02 * side * unit(), 0, 0, 1;
    if (parameters.model == LensModel::brown) {
      constexpr std::array<double, 8> kMost = {0.2, 0.05, 1e-3, 1e-3, 0.02, 0.05, 0.02, 0.01};
      constexpr std::array<std::size_t, 4> kCounts = {0, 4, 5, 8};
      const std::size_t count = kCounts[static_cast<std::size_t>(whole(0, 3))];
      for (std::size_t i = 0; i < count; ++i) {
        parameters.distortion.push_back(kMost[i] * unit());
      }
    }
    if (parameters.model == LensModel::fisheye) {
      for (const double most : {0.1, 0.03, 0.01, 0.003}) {
        parameters.distortion.push_back(most * unit());
      }
    }
    return Lens::create(parameters).value();
  }
};

TEST(WarpProperty, ExactMapThenExactInverseReturnsToThePoint) {
  int points = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    RandomScene scene(seed);
    for (int i = 0; i < 20; ++i) {
      const Vector2d source = scene.point_of_picture();
      const auto output = scene.output_of(source);
      if (!output) continue;
      const auto back = scene.source_of_exactly(*output);
      if (!back) continue;
      ++points;
      EXPECT_LT((*back - source).norm(), 1e-6) << "seed " << seed;
    }
  }
  EXPECT_GT(points, 1950) << "of 2000";
}

TEST(WarpProperty, MeshThenExactInverseReturnsToThePoint) {
  int points = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    RandomScene scene(seed);
    const auto chosen = choose_mesh_density(scene.lens, scene.size, scene.direction,
                                            scene.q_world_camera, scene.camera);
    const WarpMesh mesh = with_shared_error(
        build_warp_mesh(scene.lens, scene.size, scene.direction, scene.q_world_camera, scene.camera,
                        scene.size, Border::crop, chosen.density));
    if (!chosen.error_px) continue;
    for (int i = 0; i < 20; ++i) {
      const Vector2d output = scene.point_of_picture();
      const auto source = source_of(mesh, output);
      if (!source) continue;
      ++points;
      // In output pixels, as the bound is.
      const auto again = scene.output_of(*source);
      ASSERT_TRUE(again) << "seed " << seed;
      EXPECT_LE((*again - output).norm(), *chosen.error_px + 1e-3) << "seed " << seed;
    }
  }
  EXPECT_GT(points, 1250);
}

TEST(WarpProperty, AKeptLensOfAStillCameraLeavesPixelsWhereTheyAre) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    RandomScene scene(seed);
    scene.camera.lens = OutputLens::kept;
    scene.camera.q_world_camera = Quaterniond::Identity();
    scene.camera.intrinsics = output_intrinsics(scene.lens.parameters(), scene.size, std::nullopt);
    const auto still = [](double) { return Quaterniond::Identity(); };
    const WarpMesh mesh = build_warp_mesh(scene.lens, scene.size, scene.direction, still,
                                          scene.camera, scene.size, Border::crop, {9, 5});
    for (const MeshVertex& vertex : mesh.vertices) {
      EXPECT_LT((vertex.output_px - vertex.source_px).norm(), 1e-3F) << "seed " << seed;
    }
    EXPECT_EQ(mesh.triangles.size(), 3U * 2 * 9 * 5);
  }
}

TEST(OutputIntrinsics, AreAsWideAsTheFieldOfViewSays) {
  const ImageSize size{1280, 720};
  const PinholeIntrinsics k = output_intrinsics({}, size, 90.0);
  const double half = std::atan((size.width / 2.0) / k.fx);
  EXPECT_NEAR(2 * half, std::acos(0.0), 1e-12);
  EXPECT_EQ(k.cx, 639.5);
  EXPECT_EQ(k.cy, 359.5);
  EXPECT_EQ(k.fx, k.fy);
}

}  // namespace
}  // namespace gimbal
