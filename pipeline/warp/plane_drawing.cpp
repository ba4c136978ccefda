#include "pipeline/warp/plane_drawing.hpp"

#include <algorithm>
#include <cstddef>

namespace gimbal {
namespace {

// More would not fit into fixed point.
constexpr double kLongestStepPx = 1 << 14;
constexpr double kFarthestPx = 1 << 30;

/// Tall enough to cost more than handing them out, short enough that all threads end together.
constexpr int kBandRows = 64;

FixedPoint to_fixed(const Eigen::Vector2d& point) {
  const Eigen::Vector2d held = point.cwiseMax(-kFarthestPx).cwiseMin(kFarthestPx);
  return {to_fixed_px(held.x()), to_fixed_px(held.y())};
}

/// A triangle with longer steps is as good as a line: should it hit the centre of a pixel at all,
/// that gets a point of the triangle.
AffineMap fixed_map(const MeshTriangle& triangle, const Eigen::Matrix<double, 2, 3>& map) {
  const bool fits = (map.leftCols<2>().array().abs() <= kLongestStepPx).all();
  if (!fits) return {to_fixed(triangle.source_middle()), {0, 0}, {0, 0}};
  return {to_fixed(map.col(2)), to_fixed(map.col(0)), to_fixed(map.col(1))};
}

double twice_area(const MeshVertex& a, const MeshVertex& b, const MeshVertex& c) {
  const Eigen::Vector2d ab = (b.output_px - a.output_px).cast<double>();
  const Eigen::Vector2d ac = (c.output_px - a.output_px).cast<double>();
  return ab.x() * ac.y() - ab.y() * ac.x();
}

bool is_outside(const MeshVertex& a, const MeshVertex& b, const MeshVertex& c, ImageSize size) {
  const Eigen::Array2f least = a.output_px.cwiseMin(b.output_px).cwiseMin(c.output_px);
  const Eigen::Array2f most = a.output_px.cwiseMax(b.output_px).cwiseMax(c.output_px);
  return most.minCoeff() < 0 || least.x() > static_cast<float>(size.width - 1) ||
         least.y() > static_cast<float>(size.height - 1);
}

/// Whether each side of the mesh, cells left out aside, lies beyond the same side of the picture.
bool surrounds(const std::vector<MeshVertex>& vertices, const WarpMesh& mesh, ImageSize size) {
  const auto last_x = static_cast<float>(size.width - 1);
  const auto last_y = static_cast<float>(size.height - 1);
  const auto at = [&](int column, int row) -> const Eigen::Vector2f& {
    const auto index = std::ptrdiff_t{row} * mesh.vertex_columns + column;
    return vertices[static_cast<std::size_t>(index)].output_px;
  };
  for (int column = 0; column < mesh.vertex_columns; ++column) {
    if (!(at(column, 0).y() < 0 && at(column, mesh.vertex_rows - 1).y() > last_y)) return false;
  }
  for (int row = 0; row < mesh.vertex_rows; ++row) {
    if (!(at(0, row).x() < 0 && at(mesh.vertex_columns - 1, row).x() > last_x)) return false;
  }
  return true;
}

bool has_all_cells(const WarpMesh& mesh) {
  constexpr std::size_t kIndicesPerCell = 6;
  return mesh.triangles.size() == kIndicesPerCell *
                                      static_cast<std::size_t>(mesh.vertex_columns - 1) *
                                      static_cast<std::size_t>(mesh.vertex_rows - 1);
}

}  // namespace

void PlaneDrawing::begin(const WarpMesh& mesh, const VideoFrame& source, MutablePlane output,
                         std::array<std::uint8_t, 2> black) {
  mesh_ = &mesh;
  siting_ = source.color.chroma_siting;
  size_ = plane_size(mesh.output_size, plane_);
  source_ = {source.planes[static_cast<std::size_t>(plane_)], plane_size(source.size, plane_),
             mesh.border};
  output_ = {output, size_.width};
  black_ = black;
  part_into_bands();
}

void PlaneDrawing::cut() {
  pieces_.clear();
  is_folded_ = false;
  const std::vector<MeshVertex> vertices = plane_vertices(*mesh_, plane_, siting_);
  const std::vector<std::uint16_t>& corners = mesh_->triangles;
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    add_piece(vertices[corners[i]], vertices[corners[i + 1]], vertices[corners[i + 2]]);
  }
  // A closed line once around the picture has each pixel in as many triangles, those turned over
  // taken off, as it goes around: in one.
  leaves_black_ = is_folded_ || !has_all_cells(*mesh_) || !surrounds(vertices, *mesh_, size_);
}

void PlaneDrawing::part_into_bands() {
  bands_.resize(static_cast<std::size_t>((size_.height + kBandRows - 1) / kBandRows));
  int begin = 0;
  for (Band& band : bands_) {
    band.rows = {begin, std::min(begin + kBandRows, size_.height)};
    band.pieces.clear();
    begin = band.rows.end;
  }
}

void PlaneDrawing::add_piece(const MeshVertex& a, const MeshVertex& b, const MeshVertex& c) {
  if (is_outside(a, b, c, size_)) return;
  is_folded_ = is_folded_ || twice_area(a, b, c) < 0;
  const MeshTriangle triangle(a, b, c);
  const Eigen::Matrix<double, 2, 3> map = triangle.source_map();
  const Piece piece{triangle.trapezoids(size_.height), fixed_map(triangle, map),
                    samples_for(map.col(0).norm(), map.col(1).norm())};
  const RowRange rows = piece.rows();
  for (int row = rows.begin; row < rows.end; row += kBandRows - row % kBandRows) {
    bands_[static_cast<std::size_t>(row / kBandRows)].pieces.push_back(pieces_.size());
  }
  pieces_.push_back(piece);
}

void PlaneDrawing::draw(int index) {
  Band& band = bands_[static_cast<std::size_t>(index)];
  if (leaves_black_) blacken(band);
  for (const std::size_t piece : band.pieces) paint(pieces_[piece], band);
}

void PlaneDrawing::paint(const Piece& piece, Band& band) const {
  const std::array<Trapezoid, 2> area = {piece.area[0].within(band.rows),
                                         piece.area[1].within(band.rows)};
  if (piece.grid.is_single()) {
    return paint_area(plane_, interpolation_, source_, piece.map, area, output_);
  }
  band.area_painter.paint(plane_, interpolation_, source_, piece.map, piece.grid, area, output_);
}

/// Only where no triangle draws, if that can be told from where rows begin and end.
void PlaneDrawing::blacken(const Band& band) const {
  struct DrawnPart {
    int begin = 0;
    int end = 0;
    int pixels = 0;
  };
  std::array<DrawnPart, kBandRows> parts;
  parts.fill({size_.width});
  for (const std::size_t piece : band.pieces) {
    for_each_span(pieces_[piece].area, size_.width, [&](const Span& span) {
      if (span.y < band.rows.begin || span.y >= band.rows.end) return;
      DrawnPart& part = parts[static_cast<std::size_t>(span.y - band.rows.begin)];
      part.begin = std::min(part.begin, span.x_begin);
      part.end = std::max(part.end, span.x_end);
      part.pixels += span.x_end - span.x_begin;
    });
  }
  for (int y = band.rows.begin; y < band.rows.end; ++y) {
    const DrawnPart& part = parts[static_cast<std::size_t>(y - band.rows.begin)];
    const bool without_gap = !is_folded_ && part.pixels == part.end - part.begin;
    blacken({y, 0, without_gap ? part.begin : size_.width});
    if (without_gap) blacken({y, part.end, size_.width});
  }
}

void PlaneDrawing::blacken(Span span) const {
  std::uint8_t* row = output_.at<1>(0, span.y);
  if (plane_ == Plane::luma)
    return void(std::fill(row + span.x_begin, row + span.x_end, black_[0]));
  for (int x = span.x_begin; x < span.x_end; ++x) {
    std::copy(black_.begin(), black_.end(), row + 2 * std::ptrdiff_t{x});
  }
}

}  // namespace gimbal
