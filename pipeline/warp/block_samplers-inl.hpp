// The arithmetic of a block of neighbouring output pixels, for one instruction set: Highway's
// sources include this file once for each (hence no #pragma once).
//
// A block has its samples within a few bytes of a few rows of the source, as long as the walk is
// nearly level. So whole pieces of these rows are loaded and the samples picked by table lookups
// within registers, which is much cheaper than an address for each.

#if defined(GIMBALD_BLOCK_SAMPLERS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GIMBALD_BLOCK_SAMPLERS_INL_HPP
#undef GIMBALD_BLOCK_SAMPLERS_INL_HPP
#else
#define GIMBALD_BLOCK_SAMPLERS_INL_HPP
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "pipeline/warp/interpolation.hpp"
#include "pipeline/warp/span_plan.hpp"

HWY_BEFORE_NAMESPACE();
namespace gimbal {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET != HWY_SCALAR

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3_DL
constexpr int kWidest = 64;
constexpr int kWidestTable = 32;  // of twice that, coordinates would have a bit less
#elif HWY_HAVE_SCALABLE
constexpr int kWidest = 16;
constexpr int kWidestTable = 16;
#else
constexpr int kWidest = static_cast<int>(hn::MaxLanes(hn::CappedTag<std::uint8_t, 32>()));
constexpr int kWidestTable = 16;
#endif

// Lines are fetched early enough to be there when the spans below come to them.
constexpr int kRowsAhead = 8;

/// The vectors of a shape; kChannels bytes a pixel.
template <int kVectorBytes, int kPixelBytes>
struct Blocks {
  static constexpr int kChannels = kPixelBytes;
  // Where a table is as large as half of a vector, that is enough for one that enlarges a little.
  static constexpr int kTableBytes = std::min(kVectorBytes, kWidestTable);
  static constexpr int kTables = kTableBytes == 32 ? 1 : kVectorBytes / kTableBytes;
  static constexpr VectorShape kShape{kVectorBytes, kTableBytes, kTables};
  static constexpr int kPixels = kVectorBytes / 2 / kChannels;
  static constexpr int kColumnBits = column_fraction_bits(kShape.table_bytes);
  using Bytes = hn::FixedTag<std::uint8_t, static_cast<std::size_t>(kVectorBytes)>;
  using Unsigned = hn::Repartition<std::uint16_t, Bytes>;
  using Signed = hn::Repartition<std::int16_t, Bytes>;
  using OutputSigned = hn::Rebind<std::int8_t, Signed>;
  using Output = hn::Rebind<std::uint8_t, Signed>;
};

template <int kBits>
HWY_INLINE std::uint16_t fraction(FixedPx px) {
  return static_cast<std::uint16_t>((px >> (kFixedPxFractionBits - kBits)) & ((1 << kBits) - 1));
}

/// For each pair of bytes, the sum of their products; weights are unsigned, levels are signed. Sums
/// have to fit 16 bits.
template <class B>
HWY_INLINE hn::Vec<typename B::Signed> weighed_sums(B, hn::Vec<typename B::Bytes> weights,
                                                    hn::Vec<typename B::Bytes> levels) {
  const typename B::Signed d;
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_SSSE3
  if constexpr (B::kShape.bytes == 16) {
    return hn::Vec<decltype(d)>{_mm_maddubs_epi16(weights.raw, levels.raw)};
  }
#if HWY_TARGET <= HWY_AVX2
  if constexpr (B::kShape.bytes == 32) {
    return hn::Vec<decltype(d)>{_mm256_maddubs_epi16(weights.raw, levels.raw)};
  }
#endif
#if HWY_TARGET <= HWY_AVX3
  if constexpr (B::kShape.bytes == 64) {
    return hn::Vec<decltype(d)>{_mm512_maddubs_epi16(weights.raw, levels.raw)};
  }
#endif
#else
  const typename B::Unsigned du;
  const auto weights_16 = hn::BitCast(du, weights);
  const auto levels_16 = hn::BitCast(d, levels);
  const auto first_level = hn::ShiftRight<8>(hn::ShiftLeft<8>(levels_16));
  const auto second_level = hn::ShiftRight<8>(levels_16);
  const auto first_weight = hn::BitCast(d, hn::And(weights_16, hn::Set(du, 0xFF)));
  const auto second_weight = hn::BitCast(d, hn::ShiftRight<8>(weights_16));
  return hn::Add(hn::Mul(first_level, first_weight), hn::Mul(second_level, second_weight));
#endif
}

/// Bytes from the first sample.
using TableStarts = std::array<std::ptrdiff_t, BlockPlan::kMostTables>;

template <class Kernel, class B>
HWY_INLINE TableStarts table_starts_of(Kernel, B, const BlockPlan& plan) {
  const auto start_of = [](int px) HWY_ATTR {
    return std::ptrdiff_t{px - Kernel::kTapsBefore} * B::kChannels;
  };
  const auto [first, second] = plan.table_starts_px;
  return {start_of(first), B::kTables > 1 ? start_of(second) : 0};
}

/// The tables of a block, from one row.
template <class B>
HWY_INLINE hn::Vec<typename B::Bytes> load_tables(B, const std::uint8_t* row,
                                                  const std::array<std::ptrdiff_t, 2>& starts) {
  const typename B::Bytes d;
  const hn::Half<decltype(d)> half;
  if constexpr (B::kTables == 1 && B::kShape.table_bytes == B::kShape.bytes) {
    return hn::LoadU(d, row + starts[0]);
  } else if constexpr (B::kTables == 1) {
    return hn::ZeroExtendVector(d, hn::LoadU(half, row + starts[0]));
  } else {
    return hn::Combine(d, hn::LoadU(half, row + starts[1]), hn::LoadU(half, row + starts[0]));
  }
}

template <class B>
HWY_INLINE hn::Vec<typename B::Bytes> look_up(B, hn::Vec<typename B::Bytes> tables,
                                              hn::Vec<typename B::Bytes> places) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3_DL
  if constexpr (B::kShape.bytes == 64) {
    return hn::Vec<typename B::Bytes>{_mm512_permutexvar_epi8(places.raw, tables.raw)};
  }
  if constexpr (B::kShape.bytes == 32) {
    return hn::Vec<typename B::Bytes>{_mm256_permutexvar_epi8(places.raw, tables.raw)};
  }
#endif
  return hn::TableLookupBytes(tables, places);
}

/// A coordinate of each lane's sample: `first` and a step for each pixel, with kBits of fraction.
/// `first` is given for each table, as if the block's first pixel were in it, and coordinates have
/// to lie between 0 and 64 pixels.
template <int kBits, class B>
HWY_INLINE hn::Vec<typename B::Unsigned> lane_coordinates(
    B, const std::array<FixedPx, BlockPlan::kMostTables>& first, FixedPx step) {
  const hn::Repartition<std::uint32_t, typename B::Bytes> d;  // two lanes in each of these
  constexpr int kFinerBits = 24;
  const auto to_finer = [](FixedPx px) HWY_ATTR {
    return static_cast<std::uint32_t>(px >> (kFixedPxFractionBits - kFinerBits));
  };
  constexpr std::uint32_t kHalf = 1U << (kFinerBits - kBits - 1);
  auto firsts = hn::Set(d, to_finer(first[0]) + kHalf);
  if constexpr (B::kTables > 1) {
    const auto in_first_table = hn::FirstN(d, hn::Lanes(d) / 2);
    firsts = hn::IfThenElse(in_first_table, firsts, hn::Set(d, to_finer(first[1]) + kHalf));
  }
  const auto steps = hn::Set(d, to_finer(step));
  const auto pixels = hn::ShiftLeft < B::kChannels == 1 ? 1 : 0 > (hn::Iota(d, 0));
  const auto even = hn::Add(firsts, hn::Mul(pixels, steps));
  const auto odd = B::kChannels == 1 ? hn::Add(even, steps) : even;
  const auto rounded = [](auto finer)
                           HWY_ATTR { return hn::ShiftRight<kFinerBits - kBits>(finer); };
  return hn::BitCast(typename B::Unsigned(), hn::Or(hn::And(rounded(even), hn::Set(d, 0xFFFF)),
                                                    hn::ShiftLeft<16>(rounded(odd))));
}

/// See BlockPlan. Columns count from the table's start to the kernel's first tap.
template <class B>
HWY_INLINE hn::Vec<typename B::Unsigned> lane_columns_of(B blocks, const BlockPlan& plan) {
  const auto [first, second] = plan.table_starts_px;
  return lane_coordinates<B::kColumnBits>(blocks, {-first * kOnePx, -second * kOnePx}, plan.step.x);
}

/// Rows count from the uppermost sample's.
template <class B>
HWY_INLINE hn::Vec<typename B::Unsigned> lane_rows_of(B blocks, const BlockPlan& plan) {
  return lane_coordinates<kRowFractionBits>(blocks, {-plan.row_shift, -plan.row_shift},
                                            plan.step.y);
}

/// A constant that stays in its register: GCC makes those that it knows anew for each block.
template <class D>
HWY_INLINE hn::Vec<D> held(D d, hn::TFromD<D> value) {
  const volatile hn::TFromD<D> unknown = value;
  return hn::Set(d, unknown);
}

/// Where two taps of each lane are for a sample in the first column of its table, as bytes; the
/// second channel begins at the second byte.
template <class B>
HWY_INLINE hn::Vec<typename B::Unsigned> first_places(B, int first_tap, int second_tap) {
  const typename B::Unsigned d;
  const auto channel = hn::And(hn::Iota(d, 0), held(d, B::kChannels - 1));
  const int taps = B::kChannels * (first_tap + second_tap * 0x100);
  return hn::Add(hn::Mul(channel, hn::Set(d, 0x101)), hn::Set(d, static_cast<std::uint16_t>(taps)));
}

/// Where the first tap of a sample lies, in the row `y` of the source.
template <class B, class Kernel>
HWY_INLINE const std::uint8_t* first_tap_row(B, Kernel, const SourcePlane& source, FixedPoint at,
                                             FixedPx y) {
  return source.memory.data + (whole_px(y) - Kernel::kTapsBefore) * source.memory.stride_bytes +
         whole_px(at.x) * std::ptrdiff_t{B::kChannels};
}

/// Calls paint(sample), where sample(at) gives a block of output whose first pixel comes from `at`.
/// Inlined, so that constants stay in registers from block to block.
template <class B, class Paint>
HWY_INLINE void with_sampler(BilinearKernel kernel, B blocks, const BlockPlan& plan,
                             const SourcePlane& source, const Paint& paint) {
  const typename B::Bytes bytes;
  const typename B::Unsigned du;
  const typename B::Signed di;
  const typename B::Output d_out;
  // Weights are bytes, so their sum is 255 at most; twice 127 makes the last division cheap.
  constexpr int kWeightOne = 254;

  const auto lane_columns = lane_columns_of(blocks, plan);
  const auto lane_rows = lane_rows_of(blocks, plan);
  const auto lane_places = first_places(blocks, 0, 1);
  const auto place_step = held(du, B::kChannels * 0x101);
  const auto column_fraction = held(du, (1 << B::kColumnBits) - 1);
  const auto weight_scale = held(di, kWeightOne << (15 - B::kColumnBits));
  const auto weight_both = held(du, 0xFF);
  const auto weight_one = held(du, kWeightOne);
  const auto row_fraction = held(di, (1 << kRowFractionBits) - 1);
  const auto sign = held(bytes, 0x80);
  const auto sign_out = held(d_out, 0x80);
  const auto level_scale = held(di, 129);  // 129 / 2^15 is 1 / 254 to within 1 / 16000

  const std::ptrdiff_t stride = source.memory.stride_bytes;
  const auto table_starts = table_starts_of(kernel, blocks, plan);
  const FixedPx row_shift = plan.row_shift;

  paint([&](FixedPoint at) HWY_ATTR __attribute__((always_inline)) {
    const auto columns = hn::Add(hn::Set(du, fraction<B::kColumnBits>(at.x)), lane_columns);
    const auto places = hn::BitCast(
        bytes, hn::Add(hn::Mul(hn::ShiftRight<B::kColumnBits>(columns), place_step), lane_places));
    const auto weight_right = hn::BitCast(
        du, hn::MulFixedPoint15(hn::BitCast(di, hn::And(columns, column_fraction)), weight_scale));
    const auto weights =
        hn::BitCast(bytes, hn::Add(hn::Mul(weight_right, weight_both), weight_one));

    const FixedPx first_row = at.y + row_shift;
    const auto rows =
        hn::BitCast(di, hn::Add(hn::Set(du, fraction<kRowFractionBits>(first_row)), lane_rows));
    const auto weight_lower = hn::And(rows, row_fraction);
    const auto weight_upper = hn::Xor(weight_lower, row_fraction);

    const std::uint8_t* row = first_tap_row(blocks, kernel, source, at, first_row);
    hwy::Prefetch(row + kRowsAhead * stride);
    const auto neighbours = [&](const std::uint8_t* from) HWY_ATTR {
      return hn::BitCast(di, look_up(blocks, load_tables(blocks, from, table_starts), places));
    };
    const auto first = neighbours(row);
    const auto second = neighbours(row + stride);
    const auto third = neighbours(row + 2 * stride);
    const auto sum_between = [&](hn::Vec<decltype(di)> pairs) HWY_ATTR {
      return weighed_sums(blocks, weights, hn::Xor(hn::BitCast(bytes, pairs), sign));
    };
    const auto upper = sum_between(hn::IfNegativeThenElse(rows, second, first));
    const auto lower = sum_between(hn::IfNegativeThenElse(rows, third, second));
    const auto sums =
        hn::Add(hn::MulFixedPoint15(upper, weight_upper), hn::MulFixedPoint15(lower, weight_lower));
    const auto levels =
        hn::DemoteTo(typename B::OutputSigned(), hn::MulFixedPoint15(sums, level_scale));
    return hn::Xor(hn::BitCast(d_out, levels), sign_out);
  });
}

/// See CatmullRomKernel::weights. Of a fraction t and of s = 1 - t, both with 15 bits: t s s and
/// t t s.
template <class V>
HWY_INLINE void bend(V t, V s, V& curved_s, V& curved_t) {
  const auto u = hn::MulFixedPoint15(t, s);
  curved_s = hn::MulFixedPoint15(u, s);
  curved_t = hn::MulFixedPoint15(u, t);
}

/// Two weights of 15 bits for each lane as bytes, of which `scale` is one.
template <class B>
HWY_INLINE hn::Vec<typename B::Bytes> as_pairs(B, hn::Vec<typename B::Signed> first,
                                               hn::Vec<typename B::Signed> second,
                                               hn::Vec<typename B::Signed> scale) {
  const auto low = hn::MulFixedPoint15(first, scale);
  const auto high = hn::ShiftLeft<8>(hn::MulFixedPoint15(second, scale));
  return hn::BitCast(typename B::Bytes(), hn::Or(low, high));
}

/// The sum down four rows of five: the lower four where the sign of `rows` is set, which otherwise
/// has the fraction.
template <class V>
HWY_INLINE V sum_down(V rows, V fraction_one, V row_0, V row_1, V row_2, V row_3, V row_4) {
  const auto t = hn::And(rows, fraction_one);
  const auto s = hn::Xor(t, fraction_one);
  V curved_s;
  V curved_t;
  bend(t, s, curved_s, curved_t);
  const auto outer_s = hn::ShiftRight<1>(curved_s);
  const auto outer_t = hn::ShiftRight<1>(curved_t);
  const auto upper_inner = hn::MulFixedPoint15(hn::IfNegativeThenElse(rows, row_2, row_1),
                                               hn::Add(s, hn::Sub(curved_s, outer_t)));
  const auto lower_inner = hn::MulFixedPoint15(hn::IfNegativeThenElse(rows, row_3, row_2),
                                               hn::Add(t, hn::Sub(curved_t, outer_s)));
  const auto upper_outer = hn::MulFixedPoint15(hn::IfNegativeThenElse(rows, row_1, row_0), outer_s);
  const auto lower_outer = hn::MulFixedPoint15(hn::IfNegativeThenElse(rows, row_4, row_3), outer_t);
  return hn::Sub(hn::Add(upper_inner, lower_inner), hn::Add(upper_outer, lower_outer));
}

/// The same with 4 x 4 taps. Weights of the inner two taps, together at most 9/8, are bytes of
/// which 226 is one; those of the outer two, together at most -1/8, have eight times the scale.
template <class B, class Paint>
HWY_INLINE void with_sampler(CatmullRomKernel kernel, B blocks, const BlockPlan& plan,
                             const SourcePlane& source, const Paint& paint) {
  const typename B::Bytes bytes;
  const typename B::Unsigned du;
  const typename B::Signed di;
  constexpr int kInnerOne = 226;
  constexpr int kOuterOne = 8 * kInnerOne;

  const auto lane_columns = lane_columns_of(blocks, plan);
  const auto lane_rows = lane_rows_of(blocks, plan);
  const auto lane_places = first_places(blocks, 1, 2);
  const auto place_step = held(du, B::kChannels * 0x101);
  const auto inner_to_outer = held(du, B::kChannels * (0x100 - 1));
  const auto column_fraction = held(du, (1 << B::kColumnBits) - 1);
  const auto inner_one = held(di, kInnerOne);
  const auto half_outer_one = held(di, kOuterOne / 2);
  const auto fraction_one = held(di, (1 << kRowFractionBits) - 1);
  const auto sign = held(bytes, 0x80);
  const auto sign_out = held(typename B::Output(), 0x80);
  const auto level_scale = held(di, 290);  // 290 / 2^15 is 2 / 226 to within 1 / 16000
  const std::ptrdiff_t stride = source.memory.stride_bytes;
  const auto table_starts = table_starts_of(kernel, blocks, plan);
  const FixedPx row_shift = plan.row_shift;

  paint([&](FixedPoint at) HWY_ATTR __attribute__((always_inline)) {
    const auto columns = hn::Add(hn::Set(du, fraction<B::kColumnBits>(at.x)), lane_columns);
    const auto places =
        hn::Add(hn::Mul(hn::ShiftRight<B::kColumnBits>(columns), place_step), lane_places);
    const auto t =
        hn::BitCast(di, hn::ShiftLeft<15 - B::kColumnBits>(hn::And(columns, column_fraction)));
    const auto s = hn::Xor(t, fraction_one);
    hn::Vec<decltype(di)> curved_s;
    hn::Vec<decltype(di)> curved_t;
    bend(t, s, curved_s, curved_t);
    const auto inner_weights =
        as_pairs(blocks, hn::Add(s, hn::Sub(curved_s, hn::ShiftRight<1>(curved_t))),
                 hn::Add(t, hn::Sub(curved_t, hn::ShiftRight<1>(curved_s))), inner_one);
    const auto outer_weights = as_pairs(blocks, curved_s, curved_t, half_outer_one);

    const FixedPx first_row = at.y + row_shift;
    const std::uint8_t* row = first_tap_row(blocks, kernel, source, at, first_row);
    hwy::Prefetch(row + kRowsAhead * stride);
    const auto sum_across = [&](const std::uint8_t* from) HWY_ATTR {
      const auto tables = hn::Xor(load_tables(blocks, from, table_starts), sign);
      const auto inner = look_up(blocks, tables, hn::BitCast(bytes, places));
      const auto outer =
          look_up(blocks, tables, hn::BitCast(bytes, hn::Add(places, inner_to_outer)));
      return hn::Sub(hn::ShiftRight<1>(weighed_sums(blocks, inner_weights, inner)),
                     hn::ShiftRight<4>(weighed_sums(blocks, outer_weights, outer)));
    };
    const auto rows =
        hn::BitCast(di, hn::Add(hn::Set(du, fraction<kRowFractionBits>(first_row)), lane_rows));
    const auto sums = sum_down(rows, fraction_one, sum_across(row), sum_across(row + stride),
                               sum_across(row + 2 * stride), sum_across(row + 3 * stride),
                               sum_across(row + 4 * stride));
    const auto levels =
        hn::DemoteTo(typename B::OutputSigned(), hn::MulFixedPoint15(sums, level_scale));
    return hn::Xor(hn::BitCast(typename B::Output(), levels), sign_out);
  });
}

#endif  // HWY_TARGET != HWY_SCALAR

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace gimbal
HWY_AFTER_NAMESPACE();

#endif  // the instruction set's own include guard
