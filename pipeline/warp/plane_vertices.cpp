#include "pipeline/warp/plane_vertices.hpp"

#include <algorithm>
#include <cstddef>

namespace gimbal {
namespace {

/// The vertex moved straight away from its neighbour by one output pixel, its source in proportion.
MeshVertex drawn_out(const MeshVertex& vertex, const MeshVertex& origin,
                     const MeshVertex& neighbour) {
  const float distance_px = (origin.output_px - neighbour.output_px).norm();
  if (!(distance_px > 0)) return vertex;  // not visible, or folded to a point
  const float share = std::min(1.0F / distance_px, 1.0F);
  return {vertex.source_px + share * (origin.source_px - neighbour.source_px),
          vertex.output_px + share * (origin.output_px - neighbour.output_px)};
}

std::vector<MeshVertex> with_outline_drawn_out(const WarpMesh& mesh) {
  const int columns = mesh.vertex_columns;
  const int rows = mesh.vertex_rows;
  const auto index = [columns](int column, int row) {
    return static_cast<std::size_t>(std::ptrdiff_t{row} * columns + column);
  };
  std::vector<MeshVertex> vertices = mesh.vertices;
  const auto draw_out = [&](int column, int row, int inner_column, int inner_row) {
    MeshVertex& vertex = vertices[index(column, row)];
    vertex = drawn_out(vertex, mesh.vertices[index(column, row)],
                       mesh.vertices[index(inner_column, inner_row)]);
  };
  for (int row = 0; row < rows; ++row) {
    draw_out(0, row, 1, row);
    draw_out(columns - 1, row, columns - 2, row);
  }
  for (int column = 0; column < columns; ++column) {
    draw_out(column, 0, column, 1);
    draw_out(column, rows - 1, column, rows - 2);
  }
  return vertices;
}

/// Where the first chroma sample lies, in luma pixels.
Eigen::Vector2f first_chroma_px(ChromaSiting siting) {
  return {siting == ChromaSiting::left ? 0.0F : 0.5F, 0.5F};
}

}  // namespace

ImageSize plane_size(ImageSize picture, Plane plane) {
  return plane == Plane::luma ? picture : chroma_size(picture);
}

std::int64_t nv12_bytes(ImageSize picture) {
  const ImageSize chroma = chroma_size(picture);
  return std::int64_t{picture.width} * picture.height +
         2 * std::int64_t{chroma.width} * chroma.height;
}

std::vector<MeshVertex> plane_vertices(const WarpMesh& mesh, Plane plane, ChromaSiting siting) {
  if (plane == Plane::luma) return mesh.vertices;
  std::vector<MeshVertex> vertices = with_outline_drawn_out(mesh);
  const Eigen::Vector2f first = first_chroma_px(siting);
  for (MeshVertex& vertex : vertices) {
    vertex.source_px = (vertex.source_px - first) / 2;
    vertex.output_px = (vertex.output_px - first) / 2;
  }
  return vertices;
}

}  // namespace gimbal
