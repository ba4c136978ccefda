#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <utility>

#include "pipeline/warp/span.hpp"

namespace gimbal {

/// Rows begin to end - 1.
struct RowRange {
  int begin = 0;
  int end = 0;

  [[nodiscard]] constexpr bool empty() const { return begin >= end; }
};

/// What two ranges share, which may be nothing.
constexpr RowRange overlap(RowRange a, RowRange b) {
  return {std::max(a.begin, b.begin), std::min(a.end, b.end)};
}

/// All rows from the first to the last of two ranges.
constexpr RowRange around(RowRange a, RowRange b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.begin, b.begin), std::max(a.end, b.end)};
}

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

/// The first pixel that is not to the left of `x`, held between 0 and `width`.
constexpr int first_pixel_right_of(FixedPx x, int width) {
  const FixedPx pixel = (x + kOnePx - 1) >> kFixedPxFractionBits;
  return static_cast<int>(std::clamp<FixedPx>(pixel, 0, width));
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

  /// Where row `y` is crossed, and how much farther to the right the next one is.
  [[nodiscard]] FixedPx x_at(int y) const { return x_ + (y - rows_.begin) * step_; }
  [[nodiscard]] FixedPx step() const { return step_; }

 private:
  static constexpr double kFarPx = 1 << 29;  // twice that still fits into fixed point

  RowRange rows_;
  FixedPx x_ = 0;
  FixedPx step_ = 0;
};

/// The pixels between two edges, row by row from the top down. It is consumed as it is drawn.
class Trapezoid {
 public:
  Trapezoid() = default;  ///< without rows

  /// Of the rows that both edges cross.
  Trapezoid(const EdgeCrossings& a, const EdgeCrossings& b)
      : rows_(overlap(a.rows(), b.rows())),
        x_a_(a.x_at(rows_.begin)),
        x_b_(b.x_at(rows_.begin)),
        step_a_(a.step()),
        step_b_(b.step()) {}

  [[nodiscard]] RowRange rows() const { return rows_; }

  /// The part within a picture of this width of the uppermost row, of which there has to be one.
  [[nodiscard]] Span top(int width) const {
    return {rows_.begin, first_pixel_right_of(std::min(x_a_, x_b_), width),
            first_pixel_right_of(std::max(x_a_, x_b_), width)};
  }

  /// The same of the lowest row.
  [[nodiscard]] Span bottom(int width) const {
    return within({rows_.end - 1, rows_.end}).top(width);
  }

  void drop_rows(int count) {
    rows_.begin += count;
    x_a_ += count * step_a_;
    x_b_ += count * step_b_;
  }

  [[nodiscard]] Trapezoid within(RowRange rows) const {
    Trapezoid part = *this;
    part.drop_rows(std::max(rows.begin - rows_.begin, 0));
    part.rows_.end = std::min(rows.end, rows_.end);
    return part;
  }

  [[nodiscard]] Trapezoid moved(int columns, int rows) const {
    Trapezoid copy = *this;
    copy.rows_.begin += rows;
    copy.rows_.end += rows;
    copy.x_a_ += columns * kOnePx;
    copy.x_b_ += columns * kOnePx;
    return copy;
  }

 private:
  RowRange rows_;
  FixedPx x_a_ = 0;
  FixedPx x_b_ = 0;
  FixedPx step_a_ = 0;
  FixedPx step_b_ = 0;
};

/// Calls draw(span) for each row that has pixels within a picture of this width.
template <typename DrawSpan>
void for_each_span(std::span<const Trapezoid> area, int width, DrawSpan&& draw) {
  for (Trapezoid rest : area) {
    for (; !rest.rows().empty(); rest.drop_rows(1)) {
      const Span span = rest.top(width);
      if (span.x_begin != span.x_end) draw(span);
    }
  }
}

}  // namespace gimbal
