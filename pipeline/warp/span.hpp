#pragma once

#include <cstddef>
#include <cstdint>

#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// A part of one row of the output: pixels x_begin to x_end - 1.
struct Span {
  int y;
  int x_begin;
  int x_end;
};

/// What is drawn from: one plane of a picture, and what continues it past its edge (mirror, or else
/// its outermost pixels).
struct SourcePlane {
  ConstPlane memory;
  ImageSize size;  ///< pixels; a pixel of the chroma plane is a pair of bytes
  Border border;
};

/// What is drawn into.
struct OutputPlane {
  MutablePlane memory;
  int width;  ///< pixels

  /// Where a pixel of kChannels bytes lies in memory.
  template <int kChannels>
  [[nodiscard]] std::uint8_t* at(int x, int y) const {
    return memory.data + y * memory.stride_bytes + std::ptrdiff_t{x} * kChannels;
  }
};

/// A coordinate in pixels: 32 bits whole, 32 bits of fraction.
using FixedPx = std::int64_t;

constexpr int kFixedPxFractionBits = 32;
constexpr FixedPx kOnePx = FixedPx{1} << kFixedPxFractionBits;

constexpr FixedPx to_fixed_px(double px) {
  return static_cast<FixedPx>(px * static_cast<double>(kOnePx));
}

constexpr int whole_px(FixedPx px) {
  return static_cast<int>(px >> kFixedPxFractionBits);
}

struct FixedPoint {
  FixedPx x;
  FixedPx y;
};

constexpr FixedPoint operator+(FixedPoint a, FixedPoint b) {
  return {a.x + b.x, a.y + b.y};
}

constexpr FixedPoint operator*(FixedPx factor, FixedPoint point) {
  return {factor * point.x, factor * point.y};
}

/// A straight walk through the source, one step an output pixel.
struct SourceWalk {
  FixedPoint start;
  FixedPoint step;
};

/// Where each output pixel of a plane comes from: source = at_origin + x * per_column + y *
/// per_row.
struct AffineMap {
  FixedPoint at_origin;
  FixedPoint per_column;
  FixedPoint per_row;

  [[nodiscard]] constexpr FixedPoint at(int x, int y) const {
    return at_origin + x * per_column + y * per_row;
  }
};

}  // namespace gimbal
