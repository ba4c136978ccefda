#include "pipeline/warp/sample_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pipeline/warp/mesh_triangle.hpp"

namespace gimbal {
namespace {

constexpr int kMostSamples = 8;  // 64 of 8 bits fit 16

int samples_along(double step_px) {
  constexpr double kStillOne = 1.25;
  if (!(step_px > kStillOne)) return 1;  // or no number: the triangle covers nothing
  return static_cast<int>(std::ceil(std::min(step_px - (kStillOne - 1), double{kMostSamples})));
}

}  // namespace

SampleGrid samples_for(double column_step_px, double row_step_px) {
  return {samples_along(column_step_px), samples_along(row_step_px)};
}

bool shrinks(const WarpMesh& mesh) {
  for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3) {
    const MeshTriangle triangle(mesh.vertices[mesh.triangles[i]],
                                mesh.vertices[mesh.triangles[i + 1]],
                                mesh.vertices[mesh.triangles[i + 2]]);
    const Eigen::Matrix<double, 2, 3> map = triangle.source_map();
    if (!samples_for(map.col(0).norm(), map.col(1).norm()).is_single()) return true;
  }
  return false;
}

}  // namespace gimbal
