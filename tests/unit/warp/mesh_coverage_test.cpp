// Which pixels a mesh covers: the fast count against the definition, pixel by pixel.

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "pipeline/warp/mesh_triangle.hpp"
#include "pipeline/warp/warp_mesh.hpp"
#include "tests/unit/warp/warp_scene.hpp"

namespace gimbal {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr ImageSize kSource{160, 90};

/// Border pixels by the definition: no source, or a source outside of the frame.
std::int64_t count_by_source(const WarpMesh& mesh) {
  const Vector2d last(mesh.source_size.width - 0.5, mesh.source_size.height - 0.5);
  std::int64_t border = 0;
  for (int y = 0; y < mesh.output_size.height; ++y) {
    for (int x = 0; x < mesh.output_size.width; ++x) {
      const auto source = source_of(mesh, Vector2d(x, y));
      const bool in_frame = source && source->minCoeff() >= -0.5 && source->x() <= last.x() &&
                            source->y() <= last.y();
      border += in_frame ? 0 : 1;
    }
  }
  return border;
}

TEST(BorderPixels, KnownCounts) {
  const auto moved_by = [](Vector2d shift) {
    return warp_scene::mesh_of_map(kSource, kSource, Border::crop,
                                   [shift](Vector2d source) { return Vector2d(source + shift); });
  };
  EXPECT_EQ(count_border_pixels(moved_by({0, 0})), 0);
  EXPECT_EQ(count_border_pixels(moved_by({10, 0})), 10 * 90);
  EXPECT_EQ(count_border_pixels(moved_by({-10, 4})), 160 * 90 - 150 * 86);
  EXPECT_EQ(count_border_pixels(moved_by({0.4, -0.4})), 0) << "all centres are still covered";
  EXPECT_EQ(count_border_pixels(moved_by({0.6, 0})), 90);
  EXPECT_EQ(count_border_pixels(moved_by({500, 0})), 160 * 90);
}

struct Motion {
  std::string name;
  double turn_rad;     ///< of the virtual camera against the real one
  double readout_rad;  ///< of the real one while its rows are read
};

class BorderPixelsAfter : public testing::TestWithParam<Motion> {};

TEST_P(BorderPixelsAfter, MatchTheDefinitionOnEveryPixel) {
  const Motion& motion = GetParam();
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto random_axis = [&] {
    return Vector3d(unit(generator), unit(generator), unit(generator)).normalized();
  };
  const Lens lens = warp_scene::ipod_lens(kSource);
  for (int trial = 0; trial < 8; ++trial) {
    const Vector3d readout_axis = random_axis();
    const auto pose = [&](double line) {  // bends the outline
      const double s = line / kSource.height;
      return Quaterniond(AngleAxisd(motion.readout_rad * s * (1 + s), readout_axis));
    };
    VirtualCamera camera;
    camera.q_world_camera = AngleAxisd(motion.turn_rad, random_axis());
    camera.intrinsics = warp_scene::ipod_intrinsics(kSource);
    const Border border = trial % 2 == 0 ? Border::black : Border::mirror;
    const WarpMesh mesh = build_warp_mesh(lens, kSource, ReadoutDirection::top_down, pose, camera,
                                          {150, 101}, border, {9, 7});
    EXPECT_EQ(count_border_pixels(mesh), count_by_source(mesh)) << "trial " << trial;
  }
}

INSTANTIATE_TEST_SUITE_P(Motions, BorderPixelsAfter,
                         testing::Values(Motion{"Calm", 0.03, 0.01}, Motion{"Shaken", 0.1, 0.1},
                                         Motion{"PartlyOutside", 0.4, 0.1},
                                         Motion{"PartlyBehind", 1.35, 0.1},
                                         Motion{"Bent", 0.1, 0.4}, Motion{"FoldedOver", 0.2, 1.6}),
                         [](const auto& motion) { return motion.param.name; });

/// Vertices on pixel centres are the hard case: every edge is a tie.
TEST(MeshTriangle, SharedEdgesGiveEachPixelToExactlyOneTriangle) {
  std::mt19937 generator(3);
  std::uniform_int_distribution<int> jitter(-2, 2);
  const int columns = 7;
  const int rows = 6;
  std::vector<MeshVertex> grid;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const bool inner = row > 0 && row < rows - 1 && column > 0 && column < columns - 1;
      const Eigen::Vector2f moved(static_cast<float>(inner ? jitter(generator) : 0),
                                  static_cast<float>(inner ? jitter(generator) : 0));
      const Eigen::Vector2f at(static_cast<float>(8 * column), static_cast<float>(8 * row));
      grid.push_back({at, at + moved});
    }
  }
  const ImageSize size{8 * (columns - 1), 8 * (rows - 1)};
  std::vector<int> drawn(static_cast<std::size_t>(size.width * size.height));
  std::vector<int> covered(drawn.size());
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      const auto at = [&](int c, int r) {
        return grid[static_cast<std::size_t>((row + r) * columns + column + c)];
      };
      for (const MeshTriangle& triangle : {MeshTriangle(at(0, 0), at(1, 0), at(0, 1)),
                                           MeshTriangle(at(1, 0), at(1, 1), at(0, 1))}) {
        triangle.for_each_span(size, [&](int y, int x_begin, int x_end) {
          for (int x = x_begin; x < x_end; ++x) {
            ++drawn[static_cast<std::size_t>(y * size.width + x)];
          }
        });
        for (int y = 0; y < size.height; ++y) {
          for (int x = 0; x < size.width; ++x) {
            covered[static_cast<std::size_t>(y * size.width + x)] +=
                triangle.covers(Vector2d(x, y)) ? 1 : 0;
          }
        }
      }
    }
  }
  EXPECT_EQ(drawn, std::vector<int>(drawn.size(), 1));
  EXPECT_EQ(covered, std::vector<int>(covered.size(), 1));
}

TEST(MeshTriangle, MapsItsCornersAndItsMiddle) {
  const MeshTriangle triangle({{10, 20}, {1.5F, 2.25F}}, {{30, 25}, {40.75F, 8}},
                              {{15, 60}, {7, 33.5F}});
  EXPECT_LT((triangle.source_at({1.5, 2.25}) - Vector2d(10, 20)).norm(), 1e-9);
  EXPECT_LT((triangle.source_at({40.75, 8}) - Vector2d(30, 25)).norm(), 1e-9);
  EXPECT_LT((triangle.source_at({7, 33.5}) - Vector2d(15, 60)).norm(), 1e-9);
  EXPECT_LT(
      (triangle.source_at({(1.5 + 40.75 + 7) / 3, (2.25 + 8 + 33.5) / 3}) - Vector2d(55.0 / 3, 35))
          .norm(),
      1e-9);
}

TEST(MeshTriangle, WithoutAreaCoversNothing) {
  const MeshTriangle line({{0, 0}, {0, 0}}, {{5, 5}, {5, 5}}, {{9, 9}, {9, 9}});
  int spans = 0;
  line.for_each_span({20, 20}, [&](int, int, int) { ++spans; });
  EXPECT_EQ(spans, 0);
  EXPECT_FALSE(line.covers({5, 5}));
}

}  // namespace
}  // namespace gimbal
