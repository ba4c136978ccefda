#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/span.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// Rows begin to end - 1.
struct RowRange {
  int begin;
  int end;
};

/// The line between two points of the output, from the upper to the lower.
class OutputEdge {
 public:
  OutputEdge(const Eigen::Vector2d& a, const Eigen::Vector2d& b) : top_(a), bottom_(b) {
    if (is_below(top_, bottom_)) std::swap(top_, bottom_);
    dx_dy_ = (bottom_.x() - top_.x()) / (bottom_.y() - top_.y());
  }

  /// Where the edge crosses the row `y`, for top().y() <= y < bottom().y().
  [[nodiscard]] double x_at(double y) const { return top_.x() + (y - top_.y()) * dx_dy_; }

  [[nodiscard]] double dx_dy() const { return dx_dy_; }
  [[nodiscard]] const Eigen::Vector2d& top() const { return top_; }
  [[nodiscard]] const Eigen::Vector2d& bottom() const { return bottom_; }

  [[nodiscard]] static bool is_below(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.y() > b.y() || (a.y() == b.y() && a.x() > b.x());
  }

 private:
  Eigen::Vector2d top_;
  Eigen::Vector2d bottom_;
  double dx_dy_;
};

/// The first whole coordinate at or after `coordinate`, held between 0 and `end`.
inline int first_pixel(double coordinate, int end) {
  const double held = std::clamp(coordinate, 0.0, static_cast<double>(end));
  const int floor = static_cast<int>(held);
  return floor + (floor < held ? 1 : 0);
}

/// Where an edge crosses one row of pixels after the other. Both triangles beside an edge, and all
/// parts that a picture is drawn in, compute the very same crossings: no pixel between them is lost
/// or drawn twice.
class EdgeCrossings {
 public:
  /// Those with the rows below the edge's top and not below its bottom.
  EdgeCrossings(const OutputEdge& edge, int picture_height)
      : rows_{first_pixel(edge.top().y(), picture_height),
              first_pixel(edge.bottom().y(), picture_height)} {
    const int steps = rows_.end - rows_.begin - 1;
    if (steps < 0) return;
    x_ = to_fixed_px(std::clamp(edge.x_at(rows_.begin), -kFarPx, kFarPx));
    // Not where the edge is so level that its slope has no meaning.
    if (steps > 0) step_ = to_fixed_px(std::clamp(edge.dx_dy(), -kFarPx / steps, kFarPx / steps));
  }

  [[nodiscard]] RowRange rows() const { return rows_; }

  /// The first pixel of row `y` that is not to the left of the edge, held between 0 and `width`.
  [[nodiscard]] int first_pixel_right_of(int y, int width) const {
    const FixedPx x = x_ + (y - rows_.begin) * step_;
    return static_cast<int>(
        std::clamp<FixedPx>((x + kOnePx - 1) >> kFixedPxFractionBits, 0, width));
  }

 private:
  static constexpr double kFarPx = 1 << 29;  // twice that still fits into fixed point

  RowRange rows_;
  FixedPx x_ = 0;
  FixedPx step_ = 0;
};

/// A triangle of a mesh as it is drawn. A pixel belongs to it if its centre lies inside, on an
/// upper edge or on a left edge; edges shared by two triangles give each pixel to exactly one of
/// them.
class MeshTriangle {
 public:
  MeshTriangle(MeshVertex a, MeshVertex b, MeshVertex c) {
    if (is_below(a, b)) std::swap(a, b);
    if (is_below(b, c)) std::swap(b, c);
    if (is_below(a, b)) std::swap(a, b);
    output_ = {a.output_px.cast<double>(), b.output_px.cast<double>(), c.output_px.cast<double>()};
    const Eigen::Vector2d source[] = {a.source_px.cast<double>(), b.source_px.cast<double>(),
                                      c.source_px.cast<double>()};
    source_min_ = source[0].cwiseMin(source[1]).cwiseMin(source[2]);
    source_max_ = source[0].cwiseMax(source[1]).cwiseMax(source[2]);
    source_origin_ = source[0];
    Eigen::Matrix2d output_sides;
    output_sides << output_[1] - output_[0], output_[2] - output_[0];
    Eigen::Matrix2d source_sides;
    source_sides << source[1] - source[0], source[2] - source[0];
    const double area = output_sides.determinant();
    if (area == 0) return;  // covers nothing
    Eigen::Matrix2d adjugate;
    adjugate << output_sides(1, 1), -output_sides(0, 1), -output_sides(1, 0), output_sides(0, 0);
    source_from_output_ = source_sides * adjugate / area;
  }

  [[nodiscard]] bool covers(const Eigen::Vector2d& point) const {
    if (point.y() < output_[0].y() || point.y() >= output_[2].y()) return false;
    const auto [left, right] = crossings(point.y());
    return left <= point.x() && point.x() < right;
  }

  /// The affine map. Rounding does not carry the answer out of the triangle's own part of the
  /// source.
  [[nodiscard]] Eigen::Vector2d source_at(const Eigen::Vector2d& output) const {
    const Eigen::Vector2d source = source_origin_ + source_from_output_ * (output - output_[0]);
    return source.cwiseMax(source_min_).cwiseMin(source_max_);
  }

  /// A point of the triangle's own part of the source.
  [[nodiscard]] Eigen::Vector2d source_middle() const { return (source_min_ + source_max_) / 2; }

  /// The same affine map as a matrix: source = map * (x, y, 1). Beyond all bounds for a triangle
  /// that is nearly a line.
  [[nodiscard]] Eigen::Matrix<double, 2, 3> source_map() const {
    Eigen::Matrix<double, 2, 3> map;
    map << source_from_output_, source_origin_ - source_from_output_ * output_[0];
    return map;
  }

  /// Calls draw(y, x_begin, x_end) for each row of covered pixels inside of `size`.
  template <typename DrawSpan>
  void for_each_span(ImageSize size, DrawSpan&& draw) const {
    for_each_span(size, {0, size.height}, draw);
  }

  /// The same for those of these rows only.
  template <typename DrawSpan>
  void for_each_span(ImageSize size, RowRange rows, DrawSpan&& draw) const {
    const EdgeCrossings whole(OutputEdge(output_[0], output_[2]), size.height);
    const auto draw_rows = [&](const EdgeCrossings& other) {
      const int end = std::min(other.rows().end, rows.end);
      for (int y = std::max(other.rows().begin, rows.begin); y < end; ++y) {
        const int a = whole.first_pixel_right_of(y, size.width);
        const int b = other.first_pixel_right_of(y, size.width);
        if (a != b) draw(y, std::min(a, b), std::max(a, b));
      }
    };
    draw_rows(EdgeCrossings(OutputEdge(output_[0], output_[1]), size.height));
    draw_rows(EdgeCrossings(OutputEdge(output_[1], output_[2]), size.height));
  }

 private:
  static bool is_below(const MeshVertex& a, const MeshVertex& b) {
    return OutputEdge::is_below(a.output_px.cast<double>(), b.output_px.cast<double>());
  }

  [[nodiscard]] std::pair<double, double> crossings(double y) const {
    const OutputEdge whole(output_[0], output_[2]);
    const OutputEdge other = y < output_[1].y() ? OutputEdge(output_[0], output_[1])
                                                : OutputEdge(output_[1], output_[2]);
    return std::minmax({whole.x_at(y), other.x_at(y)});
  }

  std::array<Eigen::Vector2d, 3> output_;  ///< from the top down
  Eigen::Vector2d source_min_;
  Eigen::Vector2d source_max_;
  Eigen::Vector2d source_origin_;
  Eigen::Matrix2d source_from_output_ = Eigen::Matrix2d::Zero();
};

}  // namespace gimbal
