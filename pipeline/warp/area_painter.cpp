#include "pipeline/warp/area_painter.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace gimbal {
namespace {

/// The i-th of `count` samples, from the middle of a step.
FixedPoint offset(FixedPoint step, int i, int count) {
  const FixedPx numerator = 2 * i + 1 - count;
  return {numerator * step.x / (2 * count), numerator * step.y / (2 * count)};
}

/// The rectangle of pixels around an area that has some.
struct Rectangle {
  Rectangle(std::span<const Trapezoid> area, int width) {
    int right = 0;
    int bottom = 0;
    for_each_span(area, width, [&](const Span& span) {
      left = std::min(left, span.x_begin);
      right = std::max(right, span.x_end);
      top = std::min(top, span.y);
      bottom = std::max(bottom, span.y + 1);
    });
    columns = std::max(0, right - left);
    rows = std::max(0, bottom - top);
  }

  int left = std::numeric_limits<int>::max();
  int top = std::numeric_limits<int>::max();
  int columns;
  int rows;
};

}  // namespace

void AreaPainter::paint(Plane plane, Interpolation interpolation, const SourcePlane& source,
                        const AffineMap& map, SampleGrid grid, std::span<const Trapezoid, 2> area,
                        const OutputPlane& output) {
  const int channels = plane == Plane::luma ? 1 : 2;
  const Rectangle around(area, output.width);
  if (around.rows == 0) return;
  const std::ptrdiff_t row_bytes = std::ptrdiff_t{around.columns} * channels;
  samples_.resize(static_cast<std::size_t>(row_bytes * around.rows));
  sums_.assign(samples_.size(), 0);
  const std::array<Trapezoid, 2> moved = {area[0].moved(-around.left, -around.top),
                                          area[1].moved(-around.left, -around.top)};
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const FixedPoint start = map.at(around.left, around.top) +
                               offset(map.per_row, row, grid.rows) +
                               offset(map.per_column, column, grid.columns);
      paint_area(plane, interpolation, source, {start, map.per_column, map.per_row}, moved,
                 {{samples_.data(), row_bytes}, around.columns});
      add_samples();
    }
  }
  const int count = grid.columns * grid.rows;
  for_each_span(area, output.width, [&](const Span& span) {
    const std::uint16_t* sum = sums_.data() + (span.y - around.top) * row_bytes +
                               std::ptrdiff_t{span.x_begin - around.left} * channels;
    std::uint8_t* out = output.at<1>(0, span.y);
    for (int i = span.x_begin * channels; i < span.x_end * channels; ++i) {
      out[i] = static_cast<std::uint8_t>((*sum++ + count / 2) / count);
    }
  });
}

void AreaPainter::add_samples() {
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    sums_[i] = static_cast<std::uint16_t>(sums_[i] + samples_[i]);
  }
}

}  // namespace gimbal
