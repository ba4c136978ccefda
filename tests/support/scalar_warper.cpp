#include "tests/support/scalar_warper.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/warp/black_level.hpp"
#include "pipeline/warp/mesh_triangle.hpp"
#include "pipeline/warp/plane_vertices.hpp"

namespace gimbal {
namespace {

constexpr int kWeightOne = 1 << 11;  // 8 bits of picture and two weights of 11 bits fit an int

/// A coordinate between two pixels.
struct Neighbours {
  int first;
  int second;
  int weight_second;
};

int held(int i, int length, Border border) {
  if (border != Border::mirror) return std::clamp(i, 0, length - 1);
  while (i < 0 || i >= length) i = i < 0 ? -1 - i : 2 * length - 1 - i;
  return i;
}

Neighbours neighbours(double px, int length, Border border) {
  const auto steps = static_cast<std::int64_t>(std::floor(px * kWeightOne));
  const int first = static_cast<int>(steps >> 11);
  return {held(first, length, border), held(first + 1, length, border),
          static_cast<int>(steps & (kWeightOne - 1))};
}

int mix(int a, int b, int weight_b) {
  return a * (kWeightOne - weight_b) + b * weight_b;
}

template <std::size_t kChannels>
void draw_plane(const WarpMesh& mesh, Plane plane, const VideoFrame& source, MutablePlane output,
                const std::array<std::uint8_t, kChannels>& black) {
  const ConstPlane& memory = source.planes[static_cast<std::size_t>(plane)];
  const ImageSize source_size = plane_size(source.size, plane);
  const ImageSize size = plane_size(mesh.output_size, plane);
  const auto pixel_of = [&](int x, int y) {
    return output.data + y * output.stride_bytes + x * static_cast<std::ptrdiff_t>(kChannels);
  };
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) std::copy(black.begin(), black.end(), pixel_of(x, y));
  }
  const auto draw = [&](const Eigen::Vector2d& at, std::uint8_t* out) {
    const Neighbours x = neighbours(at.x(), source_size.width, mesh.border);
    const Neighbours y = neighbours(at.y(), source_size.height, mesh.border);
    for (std::size_t channel = 0; channel < kChannels; ++channel) {
      const auto level = [&](int column, int row) -> int {
        return memory
            .data[row * memory.stride_bytes + column * static_cast<std::ptrdiff_t>(kChannels) +
                  static_cast<std::ptrdiff_t>(channel)];
      };
      const int above = mix(level(x.first, y.first), level(x.second, y.first), x.weight_second);
      const int below = mix(level(x.first, y.second), level(x.second, y.second), x.weight_second);
      constexpr int kOne = kWeightOne * kWeightOne;
      out[channel] =
          static_cast<std::uint8_t>((mix(above, below, y.weight_second) + kOne / 2) / kOne);
    }
  };
  const std::vector<MeshVertex> vertices = plane_vertices(mesh, plane, source.color.chroma_siting);
  for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3) {
    const MeshTriangle triangle(vertices[mesh.triangles[i]], vertices[mesh.triangles[i + 1]],
                                vertices[mesh.triangles[i + 2]]);
    triangle.for_each_span(size, [&](int y, int x_begin, int x_end) {
      for (int x = x_begin; x < x_end; ++x) draw(triangle.source_at({x, y}), pixel_of(x, y));
    });
  }
}

}  // namespace

VideoFrame warp_by_scalars(const VideoFrame& source, const WarpMesh& mesh) {
  Nv12Buffer picture(mesh.output_size);
  const BlackLevel black = black_level(source.color);
  draw_plane<1>(mesh, Plane::luma, source, picture.luma(), {black.luma});
  draw_plane<2>(mesh, Plane::chroma, source, picture.chroma(), black.chroma);
  return std::move(picture).publish(source.stamp, source.color);
}

}  // namespace gimbal
