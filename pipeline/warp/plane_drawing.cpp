#include "pipeline/warp/plane_drawing.hpp"

#include <algorithm>
#include <cstddef>

namespace gimbal {
namespace {

// More would not fit into fixed point.
constexpr double kLongestStepPx = 1 << 14;
constexpr double kFarthestPx = 1 << 30;

/// Tall enough to cost more than handing them out, short enough that all threads end together.
constexpr int kBandRows = 128;

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

}  // namespace

void PlaneDrawing::begin(const WarpMesh& mesh, const VideoFrame& source, MutablePlane output,
                         std::array<std::uint8_t, 2> black) {
  source_ = {source.planes[static_cast<std::size_t>(plane_)], plane_size(source.size, plane_),
             mesh.border};
  output_ = output;
  size_ = plane_size(mesh.output_size, plane_);
  black_ = black;
  const std::vector<MeshVertex> vertices = plane_vertices(mesh, plane_, source.color.chroma_siting);
  pieces_.clear();
  is_folded_ = false;
  for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3) {
    const MeshVertex& a = vertices[mesh.triangles[i]];
    const MeshVertex& b = vertices[mesh.triangles[i + 1]];
    const MeshVertex& c = vertices[mesh.triangles[i + 2]];
    const MeshTriangle triangle(a, b, c);
    const Eigen::Matrix<double, 2, 3> map = triangle.source_map();
    pieces_.push_back(
        {triangle, fixed_map(triangle, map), samples_for(map.col(0).norm(), map.col(1).norm())});
    is_folded_ = is_folded_ || twice_area(a, b, c) < 0;
  }
  part_into_bands();
}

void PlaneDrawing::part_into_bands() {
  bands_.resize(static_cast<std::size_t>((size_.height + kBandRows - 1) / kBandRows));
  int begin = 0;
  for (Band& band : bands_) {
    band.rows = {begin, std::min(begin + kBandRows, size_.height)};
    begin = band.rows.end;
  }
}

void PlaneDrawing::draw(int index) {
  Band& band = bands_[static_cast<std::size_t>(index)];
  find_spans(band);
  blacken(band);
  std::size_t begin = 0;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const std::span own = std::span(band.spans).subspan(begin, band.ends[i] - begin);
    if (!own.empty()) paint(pieces_[i], own, band);
    begin = band.ends[i];
  }
}

void PlaneDrawing::find_spans(Band& band) const {
  band.spans.clear();
  band.ends.clear();
  for (const Piece& piece : pieces_) {
    piece.triangle.for_each_span(size_, band.rows, [&](int y, int x_begin, int x_end) {
      band.spans.push_back({y, x_begin, x_end});
    });
    band.ends.push_back(band.spans.size());
  }
}

void PlaneDrawing::paint(const Piece& piece, std::span<const Span> spans, Band& band) const {
  if (piece.grid.is_single()) {
    return paint_spans(plane_, interpolation_, source_, piece.map, spans, output_);
  }
  band.area_painter.paint(plane_, interpolation_, source_, piece.map, piece.grid, spans, output_);
}

/// Only where no triangle draws, if that can be told from the spans alone.
void PlaneDrawing::blacken(const Band& band) const {
  struct DrawnPart {
    int begin;
    int end = 0;
    int pixels = 0;
  };
  std::array<DrawnPart, kBandRows> parts;
  parts.fill({size_.width});
  for (const Span& span : band.spans) {
    DrawnPart& part = parts[static_cast<std::size_t>(span.y - band.rows.begin)];
    part.begin = std::min(part.begin, span.x_begin);
    part.end = std::max(part.end, span.x_end);
    part.pixels += span.x_end - span.x_begin;
  }
  for (int y = band.rows.begin; y < band.rows.end; ++y) {
    const DrawnPart& part = parts[static_cast<std::size_t>(y - band.rows.begin)];
    const bool without_gap = !is_folded_ && part.pixels == part.end - part.begin;
    blacken({y, 0, without_gap ? part.begin : size_.width});
    if (without_gap) blacken({y, part.end, size_.width});
  }
}

void PlaneDrawing::blacken(Span span) const {
  std::uint8_t* row = output_.data + span.y * output_.stride_bytes;
  if (plane_ == Plane::luma)
    return void(std::fill(row + span.x_begin, row + span.x_end, black_[0]));
  for (int x = span.x_begin; x < span.x_end; ++x) {
    std::copy(black_.begin(), black_.end(), row + 2 * std::ptrdiff_t{x});
  }
}

}  // namespace gimbal
