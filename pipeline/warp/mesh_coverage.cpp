#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/warp/mesh_outline.hpp"
#include "pipeline/warp/mesh_triangle.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {
namespace {

std::size_t position(int row, int columns, int column) {
  return static_cast<std::size_t>(std::ptrdiff_t{row} * columns + column);
}

bool in_frame(const WarpMesh& mesh, const MeshVertex& vertex) {
  const auto inside = [](float at, int length) {
    return at >= -0.5F && at <= static_cast<float>(length) - 0.5F;
  };
  return inside(vertex.source_px.x(), mesh.source_size.width) &&
         inside(vertex.source_px.y(), mesh.source_size.height);
}

/// The cells of the grid that show the frame itself: inside of it and seen by the virtual camera.
class FrameCells {
 public:
  explicit FrameCells(const WarpMesh& mesh)
      : mesh_(mesh), columns_(mesh.vertex_columns - 1), rows_(mesh.vertex_rows - 1) {
    shown_.resize(static_cast<std::size_t>(std::max(columns_, 0)) *
                  static_cast<std::size_t>(std::max(rows_, 0)));
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        shown_[index(column, row)] = shows_frame(column, row);
      }
    }
  }

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }

  [[nodiscard]] bool shown(int column, int row) const {
    const bool exists = column >= 0 && column < columns_ && row >= 0 && row < rows_;
    return exists && shown_[index(column, row)];
  }

  [[nodiscard]] const MeshVertex& vertex(int column, int row) const {
    return mesh_.vertices[position(row, mesh_.vertex_columns, column)];
  }

  [[nodiscard]] Eigen::Vector2d output(int column, int row) const {
    return vertex(column, row).output_px.cast<double>();
  }

 private:
  [[nodiscard]] std::size_t index(int column, int row) const {
    return position(row, columns_, column);
  }

  [[nodiscard]] bool shows_frame(int column, int row) const {
    for (const int r : {row, row + 1}) {
      for (const int c : {column, column + 1}) {
        if (!in_frame(mesh_, vertex(c, r)) || !vertex(c, r).output_px.allFinite()) return false;
      }
    }
    return true;
  }

  const WarpMesh& mesh_;
  int columns_;
  int rows_;
  std::vector<bool> shown_;
};

template <typename Visit>
void for_each_shown_cell(const FrameCells& cells, Visit&& visit) {
  for (int row = 0; row < cells.rows(); ++row) {
    for (int column = 0; column < cells.columns(); ++column) {
      if (cells.shown(column, row)) visit(column, row);
    }
  }
}

/// Those that show the frame itself, in the order in which they are drawn.
template <typename Visit>
void for_each_shown_triangle(const WarpMesh& mesh, Visit&& visit) {
  for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3) {
    const MeshVertex& a = mesh.vertices[mesh.triangles[i]];
    const MeshVertex& b = mesh.vertices[mesh.triangles[i + 1]];
    const MeshVertex& c = mesh.vertices[mesh.triangles[i + 2]];
    if (in_frame(mesh, a) && in_frame(mesh, b) && in_frame(mesh, c)) visit(a, b, c);
  }
}

/// Whether some triangle shows its piece of the frame turned over, so that others overlap it. Only
/// a motion faster than the readout does that.
bool is_folded(const WarpMesh& mesh) {
  bool folded = false;
  for_each_shown_triangle(mesh, [&](const MeshVertex& a, const MeshVertex& b, const MeshVertex& c) {
    const Eigen::Vector2d ab = (b.output_px - a.output_px).cast<double>();
    const Eigen::Vector2d ac = (c.output_px - a.output_px).cast<double>();
    folded = folded || ab.x() * ac.y() - ab.y() * ac.x() <= 0;
  });
  return folded;
}

/// Pixels to the left of an edge of the outline, taken with the sign of its direction.
std::int64_t pixels_left_of(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                            ImageSize size) {
  const EdgeCrossings edge(OutputEdge(from, to), size.height);
  std::int64_t pixels = 0;
  for (int y = edge.rows().begin; y < edge.rows().end; ++y) {
    pixels += first_pixel_right_of(edge.x_at(y), size.width);
  }
  return from.y() < to.y() ? pixels : -pixels;
}

std::vector<OutlineEdge> outline_of(const FrameCells& cells) {
  std::vector<OutlineEdge> edges;
  for_each_shown_cell(cells, [&](int column, int row) {
    const Eigen::Vector2d top_left = cells.output(column, row);
    const Eigen::Vector2d top_right = cells.output(column + 1, row);
    const Eigen::Vector2d bottom_left = cells.output(column, row + 1);
    const Eigen::Vector2d bottom_right = cells.output(column + 1, row + 1);
    if (!cells.shown(column, row - 1)) edges.push_back({top_left, top_right});
    if (!cells.shown(column + 1, row)) edges.push_back({top_right, bottom_right});
    if (!cells.shown(column, row + 1)) edges.push_back({bottom_right, bottom_left});
    if (!cells.shown(column - 1, row)) edges.push_back({bottom_left, top_left});
  });
  return edges;
}

/// The sum over all triangles of the pixels between their left and their right edges. Edges inside
/// of the mesh cancel to the last pixel, so that only the outline is left, walked clockwise.
std::int64_t count_inside_outline(const FrameCells& cells, ImageSize size) {
  std::int64_t pixels = 0;
  for (const OutlineEdge& edge : outline_of(cells)) {
    pixels += pixels_left_of(edge.from, edge.to, size);
  }
  return pixels;
}

/// Spares the search most triangles; points on the box's sides are not outside.
bool is_outside_box(const Eigen::Vector2f& point, const Eigen::Vector2f& a,
                    const Eigen::Vector2f& b, const Eigen::Vector2f& c) {
  return (point.array() < a.cwiseMin(b).cwiseMin(c).array()).any() ||
         (point.array() > a.cwiseMax(b).cwiseMax(c).array()).any();
}

/// Slower, but right when triangles overlap.
std::int64_t count_by_marking(const WarpMesh& mesh) {
  const ImageSize size = mesh.output_size;
  std::vector<std::uint8_t> covered(static_cast<std::size_t>(size.width) *
                                    static_cast<std::size_t>(size.height));
  const auto mark = [&](int y, int x_begin, int x_end) {
    const auto row = covered.begin() + static_cast<std::ptrdiff_t>(y) * size.width;
    std::fill(row + x_begin, row + x_end, std::uint8_t{1});
  };
  for_each_shown_triangle(mesh, [&](const MeshVertex& a, const MeshVertex& b, const MeshVertex& c) {
    MeshTriangle(a, b, c).for_each_span(size, mark);
  });
  return std::count(covered.begin(), covered.end(), std::uint8_t{1});
}

}  // namespace

std::vector<OutlineEdge> outline_of(const WarpMesh& mesh) {
  return outline_of(FrameCells(mesh));
}

std::int64_t count_border_pixels(const WarpMesh& mesh) {
  const ImageSize size = mesh.output_size;
  const std::int64_t covered =
      is_folded(mesh) ? count_by_marking(mesh) : count_inside_outline(FrameCells(mesh), size);
  return std::int64_t{size.width} * size.height - covered;
}

std::optional<Eigen::Vector2d> source_of(const WarpMesh& mesh, const Eigen::Vector2d& output_px) {
  const Eigen::Vector2f point = output_px.cast<float>();
  for (std::size_t i = mesh.triangles.size(); i >= 3; i -= 3) {  // the last one drawn is seen
    const MeshVertex& a = mesh.vertices[mesh.triangles[i - 3]];
    const MeshVertex& b = mesh.vertices[mesh.triangles[i - 2]];
    const MeshVertex& c = mesh.vertices[mesh.triangles[i - 1]];
    if (is_outside_box(point, a.output_px, b.output_px, c.output_px)) continue;
    const MeshTriangle triangle(a, b, c);
    if (triangle.covers(output_px)) return triangle.source_at(output_px);
  }
  return std::nullopt;
}

}  // namespace gimbal
