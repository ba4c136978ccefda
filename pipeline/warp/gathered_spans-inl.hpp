// Spans along any walk, level or not, for one instruction set: Highway's sources include this file
// once for each (hence no #pragma once). Four bytes are fetched for each neighbouring pair of
// pixels, two of which are wanted in luma and all in chroma.

#if defined(GIMBALD_GATHERED_SPANS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GIMBALD_GATHERED_SPANS_INL_HPP
#undef GIMBALD_GATHERED_SPANS_INL_HPP
#else
#define GIMBALD_GATHERED_SPANS_INL_HPP
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "pipeline/warp/interpolation.hpp"
#include "pipeline/warp/span_plan.hpp"
#include "pipeline/warp/span_sampler.hpp"
#include "pipeline/warp/trapezoid_rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace gimbal {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET != HWY_SCALAR

namespace hn = hwy::HWY_NAMESPACE;

using GatheredLanes = hn::CappedTag<std::int32_t, 8>;

/// The fraction of lanes' coordinates, whose whole part fills the other bits.
constexpr int kGatheredFractionBits = 16;

/// Whether eight steps fit a lane.
constexpr bool fits_gathered(FixedPoint step) {
  constexpr FixedPx kLongest = FixedPx{1 << 10} * kOnePx;
  return std::max(std::max(step.x, -step.x), std::max(step.y, -step.y)) < kLongest;
}

constexpr std::int32_t to_gathered(FixedPx px) {
  return static_cast<std::int32_t>(px >> (kFixedPxFractionBits - kGatheredFractionBits));
}

/// The coordinates of a block's samples, relative to the pixel at or before the first.
HWY_INLINE hn::Vec<GatheredLanes> gathered_coordinates(FixedPx first, FixedPx step) {
  const GatheredLanes d;
  const auto steps = hn::Mul(hn::Iota(d, 0), hn::Set(d, to_gathered(step)));
  return hn::Add(hn::Set(d, to_gathered(first & (kOnePx - 1))), steps);
}

/// The level of one channel between four pixels; weights are of the second of two.
HWY_INLINE hn::Vec<GatheredLanes> gathered_level(hn::Vec<GatheredLanes> upper_left,
                                                 hn::Vec<GatheredLanes> upper_right,
                                                 hn::Vec<GatheredLanes> lower_left,
                                                 hn::Vec<GatheredLanes> lower_right,
                                                 hn::Vec<GatheredLanes> weight_right,
                                                 hn::Vec<GatheredLanes> weight_lower) {
  const GatheredLanes d;
  const auto mix = [](auto a, auto b, auto weight_b) HWY_ATTR {
    return hn::Add(hn::ShiftLeft<kTapWeightBits>(a), hn::Mul(hn::Sub(b, a), weight_b));
  };
  const auto sum = mix(mix(upper_left, upper_right, weight_right),
                       mix(lower_left, lower_right, weight_right), weight_lower);
  return hn::ShiftRight<2 * kTapWeightBits>(
      hn::Add(sum, hn::Set(d, 1 << (2 * kTapWeightBits - 1))));
}

/// A block of samples, all neighbours of which lie within the source.
template <int kChannels>
HWY_INLINE void gather_block(const SourcePlane& source, SourceWalk walk, std::uint8_t* out) {
  const GatheredLanes d;
  const auto x = gathered_coordinates(walk.start.x, walk.step.x);
  const auto y = gathered_coordinates(walk.start.y, walk.step.y);
  const auto stride = static_cast<std::int32_t>(source.memory.stride_bytes);
  const auto offsets =
      hn::Add(hn::Mul(hn::ShiftRight<kGatheredFractionBits>(y), hn::Set(d, stride)),
              hn::Mul(hn::ShiftRight<kGatheredFractionBits>(x), hn::Set(d, kChannels)));
  const std::uint8_t* first = source.memory.data +
                              whole_px(walk.start.y) * source.memory.stride_bytes +
                              whole_px(walk.start.x) * std::ptrdiff_t{kChannels};
  const auto four_bytes = [&](const std::uint8_t* base) HWY_ATTR {
    return hn::GatherOffset(d, reinterpret_cast<const std::int32_t*>(base), offsets);
  };
  const auto upper = four_bytes(first);
  const auto lower = four_bytes(first + stride);
  const auto weight_of = [&](auto coordinates) HWY_ATTR {
    return hn::And(hn::ShiftRight<kGatheredFractionBits - kTapWeightBits>(coordinates),
                   hn::Set(d, kTapWeightOne - 1));
  };
  const auto byte = [&](auto four) HWY_ATTR { return hn::And(four, hn::Set(d, 0xFF)); };
  const auto level_of = [&](auto upper_four, auto lower_four) HWY_ATTR {
    constexpr int kToRight = 8 * kChannels;
    return gathered_level(byte(upper_four), byte(hn::ShiftRight<kToRight>(upper_four)),
                          byte(lower_four), byte(hn::ShiftRight<kToRight>(lower_four)),
                          weight_of(x), weight_of(y));
  };
  const auto levels = level_of(upper, lower);
  if constexpr (kChannels == 1) {
    const hn::Rebind<std::uint8_t, GatheredLanes> d_out;
    hn::StoreU(hn::DemoteTo(d_out, levels), d_out, out);
  } else {
    const hn::Rebind<std::uint16_t, GatheredLanes> d_pairs;
    const hn::Repartition<std::uint8_t, decltype(d_pairs)> d_out;
    const auto second = level_of(hn::ShiftRight<8>(upper), hn::ShiftRight<8>(lower));
    const auto pairs = hn::DemoteTo(d_pairs, hn::Or(levels, hn::ShiftLeft<8>(second)));
    hn::StoreU(hn::BitCast(d_out, pairs), d_out, out);
  }
}

/// Bilinear; the map's steps have to fit (`fits_gathered`).
template <int kChannels>
void paint_gathered(const SourcePlane& source, const AffineMap& map,
                    std::span<const Trapezoid> area, const OutputPlane& output) {
  const int pixels = static_cast<int>(hn::Lanes(GatheredLanes()));
  const SafeArea<BilinearKernel> safe(source.size, 4 / kChannels);
  const FixedPoint step = map.per_column;
  for_each_row(
      area, output.width, [&](const Span& span) HWY_ATTR __attribute__((always_inline)) {
        std::uint8_t* out = output.at<kChannels>(span.x_begin, span.y);
        FixedPoint at = map.at(span.x_begin, span.y);
        for (int left = span.x_end - span.x_begin; left > 0; left -= pixels) {
          if (left >= pixels && safe.contains(at) && safe.contains(at + (pixels - 1) * step)) {
            gather_block<kChannels>(source, {at, step}, out);
          } else {
            sample_span<BilinearKernel, kChannels>(source, {at, step}, std::min(left, pixels), out);
          }
          out += std::ptrdiff_t{pixels} * kChannels;
          at = at + pixels * step;
        }
      });
}

#endif  // HWY_TARGET != HWY_SCALAR

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace gimbal
HWY_AFTER_NAMESPACE();

#endif  // the instruction set's own include guard
