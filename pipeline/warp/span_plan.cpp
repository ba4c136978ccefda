#include "pipeline/warp/span_plan.hpp"

#include <algorithm>

#include "pipeline/warp/interpolation.hpp"

namespace gimbal {
namespace {

constexpr FixedPx floor_px(FixedPx px) {
  return px & ~(kOnePx - 1);
}

}  // namespace

template <class Kernel, int kChannels>
bool plan_block(BlockPlan& plan, VectorShape shape, FixedPoint step) {
  const int pixels = shape.bytes / 2 / kChannels;
  const int table_outputs = pixels / shape.tables;
  if ((pixels - 1) * std::max(step.y, -step.y) > kOnePx) return false;
  // The first sample's own fraction is added, and the table has all taps of each sample.
  const FixedPx reach = (shape.table_bytes / kChannels - Kernel::kTaps) * kOnePx;
  if ((table_outputs - 1) * std::max(step.x, -step.x) > reach) return false;
  plan.step = step;
  plan.row_shift = std::min<FixedPx>(0, (pixels - 1) * step.y);
  for (int table = 0; table < shape.tables; ++table) {
    const FixedPx first_x = table * table_outputs * step.x;
    const FixedPx last_x = first_x + (table_outputs - 1) * step.x;
    const FixedPx start = floor_px(std::min(first_x, last_x));
    if (std::max(first_x, last_x) - start > reach) return false;
    plan.table_starts_px[static_cast<std::size_t>(table)] = whole_px(start);
  }
  return true;
}

template bool plan_block<BilinearKernel, 1>(BlockPlan&, VectorShape, FixedPoint);
template bool plan_block<BilinearKernel, 2>(BlockPlan&, VectorShape, FixedPoint);
template bool plan_block<CatmullRomKernel, 1>(BlockPlan&, VectorShape, FixedPoint);
template bool plan_block<CatmullRomKernel, 2>(BlockPlan&, VectorShape, FixedPoint);

}  // namespace gimbal
