// Spans along any walk, level or not, for one instruction set: Highway's sources include this file
// once for each (hence no #pragma once). Four bytes are fetched at once: the taps of a
// row of luma, or two pixels of chroma.

#if defined(GIMBALD_GATHERED_SPANS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GIMBALD_GATHERED_SPANS_INL_HPP
#undef GIMBALD_GATHERED_SPANS_INL_HPP
#else
#define GIMBALD_GATHERED_SPANS_INL_HPP
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
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
constexpr int kMostGatheredBytes = 2 * 8;

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

/// Where a block's samples lie: bytes from the pixel at or before the first, and fractions of as
/// many bits as weights have.
template <int kChannels>
HWY_INLINE hn::Vec<GatheredLanes> gathered_offsets(hn::Vec<GatheredLanes> x,
                                                   hn::Vec<GatheredLanes> y,
                                                   std::ptrdiff_t stride_bytes) {
  const GatheredLanes d;
  const auto stride = hn::Set(d, static_cast<std::int32_t>(stride_bytes));
  return hn::Add(hn::Mul(hn::ShiftRight<kGatheredFractionBits>(y), stride),
                 hn::Mul(hn::ShiftRight<kGatheredFractionBits>(x), hn::Set(d, kChannels)));
}

template <int kBits>
HWY_INLINE hn::Vec<GatheredLanes> gathered_fraction(hn::Vec<GatheredLanes> coordinates) {
  return hn::And(hn::ShiftRight<kGatheredFractionBits - kBits>(coordinates),
                 hn::Set(GatheredLanes(), (1 << kBits) - 1));
}

HWY_INLINE hn::Vec<GatheredLanes> gather_four_bytes(const std::uint8_t* base,
                                                    hn::Vec<GatheredLanes> offsets) {
  return hn::GatherOffset(GatheredLanes(), reinterpret_cast<const std::int32_t*>(base), offsets);
}

template <int kByte>
HWY_INLINE hn::Vec<GatheredLanes> byte_of(hn::Vec<GatheredLanes> four) {
  return hn::And(hn::ShiftRight<8 * kByte>(four), hn::Set(GatheredLanes(), 0xFF));
}

/// The levels of a block: one channel, or two.
HWY_INLINE void store_levels(hn::Vec<GatheredLanes> levels, std::uint8_t* out) {
  const hn::Rebind<std::uint8_t, GatheredLanes> d_out;
  hn::StoreU(hn::DemoteTo(d_out, levels), d_out, out);
}

HWY_INLINE void store_levels(hn::Vec<GatheredLanes> first, hn::Vec<GatheredLanes> second,
                             std::uint8_t* out) {
  const hn::Rebind<std::uint16_t, GatheredLanes> d_pairs;
  const hn::Repartition<std::uint8_t, decltype(d_pairs)> d_out;
  const auto pairs = hn::DemoteTo(d_pairs, hn::Or(first, hn::ShiftLeft<8>(second)));
  hn::StoreU(hn::BitCast(d_out, pairs), d_out, out);
}

HWY_INLINE const std::uint8_t* pixel_at(const SourcePlane& source, FixedPoint at, int channels) {
  return source.memory.data + whole_px(at.y) * source.memory.stride_bytes +
         whole_px(at.x) * std::ptrdiff_t{channels};
}

/// A block of samples, all neighbours of which lie within the source.
template <int kChannels>
HWY_INLINE void gather_block(BilinearKernel, const SourcePlane& source, SourceWalk walk,
                             std::uint8_t* out) {
  const auto x = gathered_coordinates(walk.start.x, walk.step.x);
  const auto y = gathered_coordinates(walk.start.y, walk.step.y);
  const std::ptrdiff_t stride = source.memory.stride_bytes;
  const auto offsets = gathered_offsets<kChannels>(x, y, stride);
  const std::uint8_t* first = pixel_at(source, walk.start, kChannels);
  const auto upper = gather_four_bytes(first, offsets);
  const auto lower = gather_four_bytes(first + stride, offsets);
  const auto weight_right = gathered_fraction<kTapWeightBits>(x);
  const auto weight_lower = gathered_fraction<kTapWeightBits>(y);
  const auto first_level =
      gathered_level(byte_of<0>(upper), byte_of<kChannels>(upper), byte_of<0>(lower),
                     byte_of<kChannels>(lower), weight_right, weight_lower);
  if constexpr (kChannels == 1) {
    store_levels(first_level, out);
  } else {
    store_levels(first_level,
                 gathered_level(byte_of<1>(upper), byte_of<3>(upper), byte_of<1>(lower),
                                byte_of<3>(lower), weight_right, weight_lower),
                 out);
  }
}

/// See CatmullRomKernel::weights. `fraction` has 15 bits.
HWY_INLINE void gathered_weights(hn::Vec<GatheredLanes> fraction, hn::Vec<GatheredLanes>& before,
                                 hn::Vec<GatheredLanes>& first, hn::Vec<GatheredLanes>& second,
                                 hn::Vec<GatheredLanes>& after) {
  const GatheredLanes d;
  const auto t = fraction;
  const auto s = hn::Sub(hn::Set(d, 1 << 15), t);
  const auto times = [](auto a, auto b) HWY_ATTR { return hn::ShiftRight<15>(hn::Mul(a, b)); };
  const auto curved_s = times(times(t, s), s);
  const auto curved_t = times(times(t, s), t);
  const auto rounded = [&](auto halves) HWY_ATTR {
    constexpr int kDropped = 16 - kTapWeightBits;
    return hn::ShiftRight<kDropped>(hn::Add(halves, hn::Set(d, 1 << (kDropped - 1))));
  };
  before = rounded(hn::Neg(curved_s));
  after = rounded(hn::Neg(curved_t));
  second = rounded(hn::Sub(hn::Add(hn::Add(t, t), hn::Add(curved_t, curved_t)), curved_s));
  const auto others = hn::Add(hn::Add(before, after), second);
  first = hn::Sub(hn::Set(d, kTapWeightOne), others);
}

/// The same with 4 x 4 taps.
template <int kChannels>
HWY_INLINE void gather_block(CatmullRomKernel, const SourcePlane& source, SourceWalk walk,
                             std::uint8_t* out) {
  using V = hn::Vec<GatheredLanes>;
  const GatheredLanes d;
  const V x = gathered_coordinates(walk.start.x, walk.step.x);
  const V y = gathered_coordinates(walk.start.y, walk.step.y);
  const std::ptrdiff_t stride = source.memory.stride_bytes;
  const V offsets = gathered_offsets<kChannels>(x, y, stride);
  V x_0, x_1, x_2, x_3;
  V y_0, y_1, y_2, y_3;
  gathered_weights(gathered_fraction<15>(x), x_0, x_1, x_2, x_3);
  gathered_weights(gathered_fraction<15>(y), y_0, y_1, y_2, y_3);
  V first_sum = hn::Set(d, 1 << (2 * kTapWeightBits - 1));
  V second_sum = first_sum;
  const auto weighed = [&](V a, V b, V c, V e) HWY_ATTR {
    return hn::Add(hn::Add(hn::Mul(a, x_0), hn::Mul(b, x_1)),
                   hn::Add(hn::Mul(c, x_2), hn::Mul(e, x_3)));
  };
  const auto add_row = [&](const std::uint8_t* taps, V weight) HWY_ATTR {
    const V left = gather_four_bytes(taps, offsets);
    if constexpr (kChannels == 1) {
      first_sum = hn::Add(first_sum, hn::Mul(weight, weighed(byte_of<0>(left), byte_of<1>(left),
                                                             byte_of<2>(left), byte_of<3>(left))));
    } else {
      const V right = gather_four_bytes(taps + 4, offsets);
      first_sum =
          hn::Add(first_sum, hn::Mul(weight, weighed(byte_of<0>(left), byte_of<2>(left),
                                                     byte_of<0>(right), byte_of<2>(right))));
      second_sum =
          hn::Add(second_sum, hn::Mul(weight, weighed(byte_of<1>(left), byte_of<3>(left),
                                                      byte_of<1>(right), byte_of<3>(right))));
    }
  };
  const std::uint8_t* taps = pixel_at(source, walk.start, kChannels) - stride - kChannels;
  add_row(taps, y_0);
  add_row(taps + stride, y_1);
  add_row(taps + 2 * stride, y_2);
  add_row(taps + 3 * stride, y_3);
  const auto level = [&](V sum) HWY_ATTR {
    return hn::Clamp(hn::ShiftRight<2 * kTapWeightBits>(sum), hn::Zero(d), hn::Set(d, 255));
  };
  if constexpr (kChannels == 1) {
    store_levels(level(first_sum), out);
  } else {
    store_levels(level(first_sum), level(second_sum), out);
  }
}

/// The map's steps have to fit (`fits_gathered`).
template <class Kernel, int kChannels>
void paint_gathered(const SourcePlane& source, const AffineMap& map,
                    std::span<const Trapezoid> area, const OutputPlane& output) {
  const int pixels = static_cast<int>(hn::Lanes(GatheredLanes()));
  const SafeArea<Kernel> safe(source.size, std::max(Kernel::kTaps, 4 / kChannels));
  const FixedPoint step = map.per_column;
  for_each_row(
      area, output.width, [&](const Span& span) HWY_ATTR __attribute__((always_inline)) {
        std::uint8_t* out = output.at<kChannels>(span.x_begin, span.y);
        FixedPoint at = map.at(span.x_begin, span.y);
        for (int left = span.x_end - span.x_begin; left > 0; left -= pixels) {
          if (!safe.contains(at) || !safe.contains(at + (pixels - 1) * step)) {
            sample_span<Kernel, kChannels>(source, {at, step}, std::min(left, pixels), out);
          } else if (left >= pixels) {
            gather_block<kChannels>(Kernel(), source, {at, step}, out);
          } else {  // nothing beside the span, which another thread may be drawing
            std::array<std::uint8_t, kMostGatheredBytes> whole;
            gather_block<kChannels>(Kernel(), source, {at, step}, whole.data());
            std::copy_n(whole.data(), left * kChannels, out);
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
