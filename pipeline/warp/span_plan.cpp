#include "pipeline/warp/span_plan.hpp"

#include <algorithm>

#include "pipeline/warp/interpolation.hpp"

namespace gimbal {
namespace {

constexpr FixedPx floor_px(FixedPx px) {
  return px & ~(kOnePx - 1);
}

constexpr std::uint16_t rounded(FixedPx px, int fraction_bits) {
  const int dropped = kFixedPxFractionBits - fraction_bits;
  return static_cast<std::uint16_t>((px + (FixedPx{1} << (dropped - 1))) >> dropped);
}

}  // namespace

template <class Kernel, int kChannels>
bool plan_block(BlockPlan& plan, VectorShape shape, FixedPoint step) {
  const int pixels = shape.bytes / 2 / kChannels;
  const int table_outputs = shape.table_bytes / 2 / kChannels;
  const int fraction_bits = column_fraction_bits(shape.table_bytes);
  if ((pixels - 1) * std::max(step.y, -step.y) > kOnePx) return false;
  // The first sample's own fraction is added, and the table has all taps of each sample.
  const FixedPx reach = (shape.table_bytes / kChannels - Kernel::kTaps) * kOnePx;
  if ((table_outputs - 1) * std::max(step.x, -step.x) > reach) return false;
  plan.row_shift = std::min<FixedPx>(0, (pixels - 1) * step.y);
  FixedPoint at{0, -plan.row_shift};
  std::size_t lane = 0;
  for (std::size_t table = 0; lane < static_cast<std::size_t>(shape.bytes / 2); ++table) {
    const FixedPx last_x = at.x + (table_outputs - 1) * step.x;
    const FixedPx start = floor_px(std::min(at.x, last_x));
    if (std::max(at.x, last_x) - start > reach) return false;
    plan.table_starts[table] = std::ptrdiff_t{whole_px(start) - Kernel::kTapsBefore} * kChannels;
    for (int output = 0; output < table_outputs; ++output, at = at + step) {
      for (int channel = 0; channel < kChannels; ++channel, ++lane) {
        plan.columns[lane] = rounded(at.x - start, fraction_bits);
        plan.rows[lane] = rounded(at.y, kRowFractionBits);
      }
    }
  }
  return true;
}

template bool plan_block<BilinearKernel, 1>(BlockPlan&, VectorShape, FixedPoint);
template bool plan_block<BilinearKernel, 2>(BlockPlan&, VectorShape, FixedPoint);
template bool plan_block<CatmullRomKernel, 1>(BlockPlan&, VectorShape, FixedPoint);
template bool plan_block<CatmullRomKernel, 2>(BlockPlan&, VectorShape, FixedPoint);

}  // namespace gimbal
