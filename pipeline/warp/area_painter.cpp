#include "pipeline/warp/area_painter.hpp"

#include <algorithm>
#include <cstddef>

namespace gimbal {
namespace {

/// The i-th of `count` samples, from the middle of a step.
FixedPoint offset(FixedPoint step, int i, int count) {
  const FixedPx numerator = 2 * i + 1 - count;
  return {numerator * step.x / (2 * count), numerator * step.y / (2 * count)};
}

/// The rectangle around spans, which come in the order of their rows.
struct Rectangle {
  explicit Rectangle(std::span<const Span> spans)
      : left(spans.front().x_begin), top(spans.front().y), rows(spans.back().y - top + 1) {
    int right = left;
    for (const Span& span : spans) {
      left = std::min(left, span.x_begin);
      right = std::max(right, span.x_end);
    }
    columns = right - left;
  }

  int left;
  int top;
  int columns = 0;
  int rows;
};

}  // namespace

void AreaPainter::paint(Plane plane, Interpolation interpolation, const SourcePlane& source,
                        const AffineMap& map, SampleGrid grid, std::span<const Span> spans,
                        MutablePlane output) {
  const int channels = plane == Plane::luma ? 1 : 2;
  const Rectangle area(spans);
  const std::ptrdiff_t row_bytes = std::ptrdiff_t{area.columns} * channels;
  samples_.resize(static_cast<std::size_t>(row_bytes * area.rows));
  sums_.assign(samples_.size(), 0);
  spans_.clear();
  for (const Span& span : spans) {
    spans_.push_back({span.y - area.top, span.x_begin - area.left, span.x_end - area.left});
  }
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const FixedPoint start = map.at(area.left, area.top) + offset(map.per_row, row, grid.rows) +
                               offset(map.per_column, column, grid.columns);
      paint_spans(plane, interpolation, source, {start, map.per_column, map.per_row}, spans_,
                  {samples_.data(), row_bytes});
      add_samples();
    }
  }
  const int count = grid.columns * grid.rows;
  for (const Span& span : spans) {
    const std::uint16_t* sum = sums_.data() + (span.y - area.top) * row_bytes +
                               std::ptrdiff_t{span.x_begin - area.left} * channels;
    std::uint8_t* out = output.data + span.y * output.stride_bytes;
    for (int i = span.x_begin * channels; i < span.x_end * channels; ++i) {
      out[i] = static_cast<std::uint8_t>((*sum++ + count / 2) / count);
    }
  }
}

void AreaPainter::add_samples() {
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    sums_[i] = static_cast<std::uint16_t>(sums_[i] + samples_[i]);
  }
}

}  // namespace gimbal
