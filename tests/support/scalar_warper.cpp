#include "tests/support/scalar_warper.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/warp/black_level.hpp"
#include "pipeline/warp/mesh_triangle.hpp"
#include "pipeline/warp/plane_vertices.hpp"

namespace gimbal {
namespace {

using Eigen::Vector2d;

int held(int i, int length, Border border) {
  if (border != Border::mirror) return std::clamp(i, 0, length - 1);
  while (i < 0 || i >= length) i = i < 0 ? -1 - i : 2 * length - 1 - i;
  return i;
}

/// Share of a pixel at this distance; both kernels by their usual definition.
double weight(Interpolation interpolation, double distance_px) {
  const double x = std::abs(distance_px);
  if (interpolation == Interpolation::bilinear) return std::max(0.0, 1 - x);
  if (x < 1) return 1.5 * x * x * x - 2.5 * x * x + 1;
  return x < 2 ? -0.5 * x * x * x + 2.5 * x * x - 4 * x + 2 : 0;
}

struct ReferencePlane {
  ConstPlane memory;
  ImageSize size;
  int channels;
  Border border;
  Interpolation interpolation;

  [[nodiscard]] double level(int x, int y, int channel) const {
    return memory.data[held(y, size.height, border) * memory.stride_bytes +
                       held(x, size.width, border) * channels + channel];
  }

  /// As a picture of 8 bits has it.
  [[nodiscard]] double sample(const Vector2d& at, int channel) const {
    const int x = static_cast<int>(std::floor(at.x()));
    const int y = static_cast<int>(std::floor(at.y()));
    double sum = 0;
    for (int row = y - 1; row <= y + 2; ++row) {
      for (int column = x - 1; column <= x + 2; ++column) {
        sum += weight(interpolation, at.x() - column) * weight(interpolation, at.y() - row) *
               level(column, row, channel);
      }
    }
    return std::clamp(sum, 0.0, 255.0);
  }
};

int samples_along(double step_px) {
  if (!(step_px > 1.25)) return 1;
  return std::min(8, static_cast<int>(std::ceil(step_px - 0.25)));
}

/// Samples around the middle of a pixel of the triangle.
std::vector<Vector2d> samples_of(const MeshTriangle& triangle, const Vector2d& pixel) {
  const Eigen::Matrix<double, 2, 3> map = triangle.source_map();
  const int columns = samples_along(map.col(0).norm());
  const int rows = samples_along(map.col(1).norm());
  if (columns == 1 && rows == 1) return {triangle.source_at(pixel)};
  std::vector<Vector2d> samples;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Vector2d from_middle((column + 0.5) / columns - 0.5, (row + 0.5) / rows - 0.5);
      samples.emplace_back(map * (pixel + from_middle).homogeneous());
    }
  }
  return samples;
}

void draw_plane(const WarpMesh& mesh, Plane plane, Interpolation interpolation,
                const VideoFrame& source, MutablePlane output,
                const std::vector<std::uint8_t>& black) {
  const int channels = static_cast<int>(black.size());
  const ReferencePlane reference{source.planes[static_cast<std::size_t>(plane)],
                                 plane_size(source.size, plane), channels, mesh.border,
                                 interpolation};
  const ImageSize size = plane_size(mesh.output_size, plane);
  const auto pixel_of = [&](int x, int y) {
    return output.data + y * output.stride_bytes + std::ptrdiff_t{x} * channels;
  };
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) std::copy(black.begin(), black.end(), pixel_of(x, y));
  }
  const std::vector<MeshVertex> vertices = plane_vertices(mesh, plane, source.color.chroma_siting);
  for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3) {
    const MeshTriangle triangle(vertices[mesh.triangles[i]], vertices[mesh.triangles[i + 1]],
                                vertices[mesh.triangles[i + 2]]);
    triangle.for_each_span(size, [&](int y, int x_begin, int x_end) {
      for (int x = x_begin; x < x_end; ++x) {
        const std::vector<Vector2d> samples = samples_of(triangle, Vector2d(x, y));
        for (int channel = 0; channel < channels; ++channel) {
          double sum = 0;
          for (const Vector2d& at : samples) sum += reference.sample(at, channel);
          pixel_of(x, y)[channel] =
              static_cast<std::uint8_t>(std::lround(sum / static_cast<double>(samples.size())));
        }
      }
    });
  }
}

}  // namespace

VideoFrame warp_by_scalars(const VideoFrame& source, const WarpMesh& mesh,
                           Interpolation interpolation) {
  Nv12Buffer picture(mesh.output_size);
  const BlackLevel black = black_level(source.color);
  draw_plane(mesh, Plane::luma, interpolation, source, picture.luma(), {black.luma});
  draw_plane(mesh, Plane::chroma, interpolation, source, picture.chroma(),
             {black.chroma[0], black.chroma[1]});
  return std::move(picture).publish(source.stamp, source.color);
}

}  // namespace gimbal
