#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/trapezoid.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

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

  /// Its pixels in a picture of this height, above and below its middle corner.
  [[nodiscard]] std::array<Trapezoid, 2> trapezoids(int height) const {
    const EdgeCrossings whole(OutputEdge(output_[0], output_[2]), height);
    return {Trapezoid(whole, EdgeCrossings(OutputEdge(output_[0], output_[1]), height)),
            Trapezoid(whole, EdgeCrossings(OutputEdge(output_[1], output_[2]), height))};
  }

  /// Calls draw(y, x_begin, x_end) for each row of covered pixels inside of `size`.
  template <typename DrawSpan>
  void for_each_span(ImageSize size, DrawSpan&& draw) const {
    gimbal::for_each_span(trapezoids(size.height), size.width,
                          [&](const Span& span) { draw(span.y, span.x_begin, span.x_end); });
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
