#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "pipeline/warp/span.hpp"

namespace gimbal {

/// How many bytes the vectors have that spans are drawn with, and how many of a row of the source a
/// table lookup reaches. Lanes have 16 bits, one for each byte of the output.
struct VectorShape {
  int bytes;
  int table_bytes;
  int tables;  ///< each for its share of the output
};

/// The fraction of a sample's column in its table, whose whole part fills the other bits of a lane.
constexpr int column_fraction_bits(int table_bytes) {
  return 16 - std::countr_zero(static_cast<unsigned>(table_bytes));
}

/// The fraction of a sample's row; the bit above tells which of two pairs of rows it lies between.
constexpr int kRowFractionBits = 15;

/// Where the samples of a block of neighbouring output pixels lie, relative to that of its first
/// pixel: each is a step from the one before. The same for all blocks of a map.
struct BlockPlan {
  static constexpr int kMostBytes = 64;  ///< of a vector
  static constexpr int kMostTables = 2;  ///< of a vector

  FixedPoint step;
  /// Where the tables start in the row, a kernel's taps before its point aside.
  std::array<int, kMostTables> table_starts_px;
  FixedPx row_shift;  ///< from the first sample to the uppermost of the block, taps aside
};

/// False where the samples of a block lie too far apart for its tables or for one row of the source
/// more than the kernel has; the plan is of no use then. `step` is from one output pixel to the
/// next, at most 2^14 pixels.
template <class Kernel, int kChannels>
[[nodiscard]] bool plan_block(BlockPlan& plan, VectorShape shape, FixedPoint step);

/// Where samples may lie so that all that a block loads lies within the source.
template <class Kernel>
class SafeArea {
 public:
  SafeArea(ImageSize size, int table_pixels)
      : x_end_((FixedPx{size.width} - table_pixels) * kOnePx),
        y_end_((FixedPx{size.height} - Kernel::kTaps + Kernel::kTapsBefore) * kOnePx) {}

  /// And so do all between two that do.
  [[nodiscard]] bool contains(FixedPoint at) const {
    // A table begins up to a pixel to the left of its leftmost sample's first tap.
    return at.x >= (Kernel::kTapsBefore + 1) * kOnePx && at.x < x_end_ &&
           at.y >= Kernel::kTapsBefore * kOnePx && at.y < y_end_;
  }

 private:
  FixedPx x_end_;
  FixedPx y_end_;
};

}  // namespace gimbal
