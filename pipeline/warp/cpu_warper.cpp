#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "pipeline/warp/black_level.hpp"
#include "pipeline/warp/mesh_triangle.hpp"
#include "pipeline/warp/picture_pool.hpp"
#include "pipeline/warp/plane_vertices.hpp"
#include "pipeline/warp/warp_input.hpp"
#include "pipeline/warp/warper.hpp"

namespace gimbal {
namespace {

/// A coordinate in the source: 32 bits whole, 32 bits of fraction.
using FixedPx = std::int64_t;

constexpr int kFractionBits = 32;
constexpr int kWeightBits = 11;  // 8 bits of picture and two weights of 11 bits fit an int
constexpr int kWeightOne = 1 << kWeightBits;

FixedPx to_fixed(double px) {
  return static_cast<FixedPx>(px * static_cast<double>(FixedPx{1} << kFractionBits));
}

int whole(FixedPx px) {
  return static_cast<int>(px >> kFractionBits);
}

int weight(FixedPx px) {
  return static_cast<int>(px >> (kFractionBits - kWeightBits)) & (kWeightOne - 1);
}

/// A straight walk through the source, one step an output pixel.
struct SourceWalk {
  FixedPx x;
  FixedPx y;
  FixedPx step_x;
  FixedPx step_y;
};

/// The walk along a row of a triangle. Computed from both ends, so that no step leaves the
/// triangle.
SourceWalk walk_along(const MeshTriangle& triangle, int y, int x_begin, int x_end) {
  const Eigen::Vector2d first = triangle.source_at({x_begin, y});
  const Eigen::Vector2d last = triangle.source_at({x_end - 1, y});
  const Eigen::Vector2d step = (last - first) / std::max(x_end - 1 - x_begin, 1);
  return {to_fixed(first.x()), to_fixed(first.y()), to_fixed(step.x()), to_fixed(step.y())};
}

/// Where the neighbours of a point lie in memory, for each rule of what is past the edge.
struct InsideOnly {
  static int index(int i, int /*length*/) { return i; }
};

struct ClampToEdge {
  static int index(int i, int length) { return std::clamp(i, 0, length - 1); }
};

/// As GL_MIRRORED_REPEAT: the outermost pixel is doubled.
struct MirrorAtEdge {
  static int index(int i, int length) {
    const int period = 2 * length;
    const int in_period = ((i % period) + period) % period;
    return std::min(in_period, period - 1 - in_period);
  }
};

struct SourcePlane {
  ConstPlane memory;
  ImageSize size;
};

/// Whether all four neighbours of every point of a walk exist.
bool stays_inside(const SourceWalk& walk, int steps, ImageSize size) {
  const auto inside = [](FixedPx px, int length) { return px >= 0 && whole(px) < length - 1; };
  const FixedPx last_x = walk.x + (steps - 1) * walk.step_x;
  const FixedPx last_y = walk.y + (steps - 1) * walk.step_y;
  return inside(walk.x, size.width) && inside(last_x, size.width) && inside(walk.y, size.height) &&
         inside(last_y, size.height);
}

int mix(int a, int b, int weight_b) {
  return a * (kWeightOne - weight_b) + b * weight_b;
}

/// Bilinear samples along a walk; kChannels bytes a pixel.
template <typename Edge, int kChannels>
void sample_span(SourcePlane source, SourceWalk walk, int pixels, std::uint8_t* out) {
  constexpr int kHalf = 1 << (2 * kWeightBits - 1);
  for (int i = 0; i < pixels; ++i, walk.x += walk.step_x, walk.y += walk.step_y) {
    const int left = Edge::index(whole(walk.x), source.size.width) * kChannels;
    const int right = Edge::index(whole(walk.x) + 1, source.size.width) * kChannels;
    const int top = Edge::index(whole(walk.y), source.size.height);
    const int bottom = Edge::index(whole(walk.y) + 1, source.size.height);
    const std::uint8_t* upper = source.memory.data + top * source.memory.stride_bytes;
    const std::uint8_t* lower = source.memory.data + bottom * source.memory.stride_bytes;
    const int weight_right = weight(walk.x);
    const int weight_bottom = weight(walk.y);
    for (int channel = 0; channel < kChannels; ++channel, ++out) {
      const int above = mix(upper[left + channel], upper[right + channel], weight_right);
      const int below = mix(lower[left + channel], lower[right + channel], weight_right);
      *out = static_cast<std::uint8_t>((mix(above, below, weight_bottom) + kHalf) >>
                                       (2 * kWeightBits));
    }
  }
}

template <int kChannels>
void draw_triangle(const MeshTriangle& triangle, const SourcePlane& source, Border border,
                   MutablePlane output, ImageSize output_size) {
  const auto past_edge = border == Border::mirror ? &sample_span<MirrorAtEdge, kChannels>
                                                  : &sample_span<ClampToEdge, kChannels>;
  triangle.for_each_span(output_size, [&](int y, int x_begin, int x_end) {
    const SourceWalk walk = walk_along(triangle, y, x_begin, x_end);
    const int pixels = x_end - x_begin;
    std::uint8_t* out = output.data + y * output.stride_bytes + std::ptrdiff_t{x_begin} * kChannels;
    const bool inside = stays_inside(walk, pixels, source.size);
    (inside ? &sample_span<InsideOnly, kChannels> : past_edge)(source, walk, pixels, out);
  });
}

template <std::size_t kChannels>
void fill(MutablePlane plane, ImageSize size, const std::array<std::uint8_t, kChannels>& pixel) {
  for (int y = 0; y < size.height; ++y) {
    std::uint8_t* row = plane.data + y * plane.stride_bytes;
    for (int x = 0; x < size.width; ++x, row += kChannels) {
      std::copy(pixel.begin(), pixel.end(), row);
    }
  }
}

template <std::size_t kChannels>
void draw_plane(const WarpMesh& mesh, Plane plane, const VideoFrame& source, MutablePlane output,
                const std::array<std::uint8_t, kChannels>& black) {
  const std::vector<MeshVertex> vertices = plane_vertices(mesh, plane, source.color.chroma_siting);
  const SourcePlane source_plane{source.planes[static_cast<std::size_t>(plane)],
                                 plane_size(source.size, plane)};
  const ImageSize output_size = plane_size(mesh.output_size, plane);
  fill(output, output_size, black);
  for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3) {
    const MeshTriangle triangle(vertices[mesh.triangles[i]], vertices[mesh.triangles[i + 1]],
                                vertices[mesh.triangles[i + 2]]);
    draw_triangle<static_cast<int>(kChannels)>(triangle, source_plane, mesh.border, output,
                                               output_size);
  }
}

class CpuWarper final : public Warper {
 public:
  Result<VideoFrame> warp(const VideoFrame& source, const WarpMesh& mesh) override {
    if (auto checked = check_warp_input(source, mesh); !checked) {
      return tl::unexpected(checked.error());
    }
    Nv12Buffer picture = pool_.take(mesh.output_size);
    const BlackLevel black = black_level(source.color);
    draw_plane<1>(mesh, Plane::luma, source, picture.luma(), {black.luma});
    draw_plane<2>(mesh, Plane::chroma, source, picture.chroma(), black.chroma);
    return pool_.publish(std::move(picture), source.stamp, source.color);
  }

  [[nodiscard]] std::string name() const override { return "cpu"; }
  [[nodiscard]] std::string renderer() const override { return "scalar"; }

 private:
  PicturePool pool_;
};

}  // namespace

std::unique_ptr<Warper> make_cpu_warper() {
  return std::make_unique<CpuWarper>();
}

}  // namespace gimbal
