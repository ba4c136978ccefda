#include "pipeline/warp/test_pattern.hpp"

#include <cstdlib>

namespace gimbal {
namespace {

int row_bytes(ImageSize picture, Plane plane) {
  const int width = plane_size(picture, plane).width;
  return plane == Plane::luma ? width : 2 * width;
}

/// A byte that tells its place: neighbours differ by more than rounding, and so do the planes.
std::uint8_t pattern_at(int x, int y, Plane plane) {
  return static_cast<std::uint8_t>(3 * x + 41 * y + (plane == Plane::luma ? 5 : 77));
}

}  // namespace

void draw_pattern(MutablePlane memory, ImageSize picture, Plane plane) {
  for (int y = 0; y < plane_size(picture, plane).height; ++y) {
    std::uint8_t* row = memory.data + y * memory.stride_bytes;
    for (int x = 0; x < row_bytes(picture, plane); ++x) row[x] = pattern_at(x, y, plane);
  }
}

bool shows_pattern(ConstPlane memory, ImageSize picture, Plane plane) {
  for (int y = 0; y < plane_size(picture, plane).height; ++y) {
    const std::uint8_t* row = memory.data + y * memory.stride_bytes;
    for (int x = 0; x < row_bytes(picture, plane); ++x) {
      if (std::abs(row[x] - pattern_at(x, y, plane)) > 1) return false;
    }
  }
  return true;
}

bool are_alike(ConstPlane a, ConstPlane b, ImageSize picture, Plane plane) {
  for (int y = 0; y < plane_size(picture, plane).height; ++y) {
    const std::uint8_t* row_a = a.data + y * a.stride_bytes;
    const std::uint8_t* row_b = b.data + y * b.stride_bytes;
    for (int x = 0; x < row_bytes(picture, plane); ++x) {
      if (std::abs(row_a[x] - row_b[x]) > 1) return false;
    }
  }
  return true;
}

MutablePlane plane_of(const Nv12Buffer& picture, Plane plane) {
  return plane == Plane::luma ? picture.luma() : picture.chroma();
}

WarpMesh identity_mesh(ImageSize size) {
  WarpMesh mesh;
  mesh.source_size = size;
  mesh.output_size = size;
  mesh.vertex_columns = 2;
  mesh.vertex_rows = 2;
  const float right = static_cast<float>(size.width) - 0.5F;
  const float bottom = static_cast<float>(size.height) - 0.5F;
  for (const float y : {-0.5F, bottom}) {
    for (const float x : {-0.5F, right}) mesh.vertices.push_back({{x, y}, {x, y}});
  }
  mesh.triangles = {0, 1, 2, 1, 3, 2};
  return mesh;
}

}  // namespace gimbal
