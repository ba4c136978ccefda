// One source for all instruction sets: Highway includes this file again for each of them, and the
// widest that the processor has is chosen when the program runs.
//
// A block of neighbouring output pixels has its samples within a few bytes of three rows of the
// source, as long as the walk is nearly level. So whole pieces of these rows are loaded and the
// samples picked by table lookups within registers, which is much cheaper than an address for each.

#include "pipeline/warp/span_painter.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "pipeline/warp/span_plan.hpp"
#include "pipeline/warp/span_sampler.hpp"

#define HWY_WANT_AVX3_DL  // lookups in tables of 32 bytes
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/warp/span_painter.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace gimbal {
namespace HWY_NAMESPACE {
namespace {

template <int kChannels>
void paint_pixels(const SourcePlane& source, const AffineMap& map, std::span<const Span> spans,
                  MutablePlane output) {
  for (const Span& span : spans) {
    sample_span<kChannels>(source, {map.at(span.x_begin, span.y), map.per_column},
                           span.x_end - span.x_begin,
                           output.data + span.y * output.stride_bytes + span.x_begin * kChannels);
  }
}

#if HWY_TARGET == HWY_SCALAR

template <int kChannels>
void paint(const SourcePlane& source, const AffineMap& map, std::span<const Span> spans,
           MutablePlane output) {
  paint_pixels<kChannels>(source, map, spans, output);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3_DL
constexpr int kWidest = 32;  // twice that gains nothing: only the tables' size limits the rest
constexpr int kWidestTable = 32;
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
  static constexpr VectorShape kShape{kVectorBytes, std::min(kVectorBytes, kWidestTable)};
  static constexpr int kTables = kShape.bytes / kShape.table_bytes;
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

/// The tables of a block, from one row.
template <class B>
HWY_INLINE hn::Vec<typename B::Bytes> load_tables(B, const std::uint8_t* row,
                                                  const std::ptrdiff_t* starts) {
  const typename B::Bytes d;
  if constexpr (B::kTables == 1) {
    return hn::LoadU(d, row + starts[0]);
  } else {
    const hn::Half<decltype(d)> half;
    return hn::Combine(d, hn::LoadU(half, row + starts[1]), hn::LoadU(half, row + starts[0]));
  }
}

template <class B>
HWY_INLINE hn::Vec<typename B::Bytes> look_up(B, hn::Vec<typename B::Bytes> tables,
                                              hn::Vec<typename B::Bytes> places) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3_DL
  if constexpr (B::kShape.table_bytes == 32) {
    return hn::Vec<typename B::Bytes>{_mm256_permutexvar_epi8(places.raw, tables.raw)};
  }
#endif
  return hn::TableLookupBytes(tables, places);
}

/// A constant that stays in its register: GCC makes those that it knows anew for each block.
template <class D>
HWY_INLINE hn::Vec<D> held(D d, hn::TFromD<D> value) {
  const volatile hn::TFromD<D> unknown = value;
  return hn::Set(d, unknown);
}

/// Where a lane's two neighbours are for a sample in the first column of its table, as bytes: the
/// right one is kChannels further, and the second channel begins at the second byte.
template <class B>
HWY_INLINE hn::Vec<typename B::Unsigned> first_places(B) {
  const typename B::Unsigned d;
  const auto channel = hn::And(hn::Iota(d, 0), held(d, B::kChannels - 1));
  return hn::Add(hn::Mul(channel, hn::Set(d, 0x101)), hn::Set(d, B::kChannels * 0x100));
}

/// Stores the first bytes only.
template <class B>
HWY_INLINE void store_some(B, hn::Vec<typename B::Output> block, int bytes, std::uint8_t* out) {
  const typename B::Output d;
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
  hn::BlendedStore(block, hn::FirstN(d, static_cast<std::size_t>(bytes)), d, out);
#else  // elsewhere that would write what is beside as well, which another thread may be drawing
  alignas(BlockPlan::kMostBytes) std::array<std::uint8_t, BlockPlan::kMostBytes> whole;
  hn::Store(block, d, whole.data());
  std::copy_n(whole.data(), bytes, out);
#endif
}

template <class B>
SafeArea safe_area(B, const SourcePlane& source) {
  return {source.size, B::kShape.table_bytes / B::kChannels};
}

/// Whether all that the blocks of some spans load is known to lie within the source.
enum class Reach : std::uint8_t { inside, past_edge };

/// Draws spans block by block; where a block reaches past the source, pixel by pixel.
template <Reach kReach, class B>
void paint_blocks(B blocks, const BlockPlan& plan, const SourcePlane& source, const AffineMap& map,
                  std::span<const Span> spans, MutablePlane output) {
  const typename B::Bytes bytes;
  const typename B::Unsigned du;
  const typename B::Signed di;
  const typename B::Output d_out;
  constexpr int kColumnOne = 1 << B::kColumnBits;
  constexpr int kRowOne = 1 << kRowFractionBits;
  // Weights are bytes, so their sum is 255 at most; twice 127 makes the last division cheap.
  constexpr int kWeightOne = 254;

  const auto lane_columns = hn::Load(du, plan.columns.data());
  const auto lane_rows = hn::Load(du, plan.rows.data());
  const auto lane_places = first_places(blocks);
  const auto place_step = held(du, B::kChannels * 0x101);
  const auto column_fraction = held(du, kColumnOne - 1);
  const auto weight_scale = held(di, kWeightOne << (15 - B::kColumnBits));
  const auto weight_both = held(du, 0xFF);
  const auto weight_one = held(du, kWeightOne);
  const auto row_fraction = held(di, kRowOne - 1);
  const auto sign = held(bytes, 0x80);
  const auto sign_out = held(d_out, 0x80);
  const auto level_scale = held(di, 129);  // 129 / 2^15 is 1 / 254 to within 1 / 16000

  const std::uint8_t* const source_data = source.memory.data;
  const std::ptrdiff_t stride = source.memory.stride_bytes;
  const std::ptrdiff_t table_starts[] = {plan.table_starts[0], plan.table_starts[1]};
  const FixedPx row_shift = plan.row_shift;

  const auto sample = [&](FixedPoint at) HWY_ATTR {
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

    const std::uint8_t* row =
        source_data + whole_px(first_row) * stride + whole_px(at.x) * std::ptrdiff_t{B::kChannels};
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
  };

  const FixedPoint step = map.per_column;
  const FixedPoint to_next_block = B::kPixels * step;
  for (const Span& span : spans) {
    std::uint8_t* out =
        output.data + span.y * output.stride_bytes + std::ptrdiff_t{span.x_begin} * B::kChannels;
    FixedPoint at = map.at(span.x_begin, span.y);
    int left = span.x_end - span.x_begin;
    if constexpr (kReach == Reach::past_edge) {
      const SafeArea safe = safe_area(blocks, source);
      for (; left > 0; left -= B::kPixels, at = at + to_next_block) {
        const int pixels = std::min(left, B::kPixels);
        if (safe.contains(at) && safe.contains(at + (B::kPixels - 1) * step)) {
          store_some(blocks, sample(at), pixels * B::kChannels, out);
        } else {
          sample_span<B::kChannels>(source, {at, step}, pixels, out);
        }
        out += B::kPixels * B::kChannels;
      }
    } else {
      if (left < B::kPixels) {
        store_some(blocks, sample(at), left * B::kChannels, out);
        continue;
      }
      while (true) {
        hwy::Prefetch(out + kRowsAhead * output.stride_bytes);
        hn::StoreU(sample(at), d_out, out);
        left -= B::kPixels;
        if (left <= 0) break;
        // The last block draws a part of the one before again, rather than less than a block.
        const int pixels = std::min(left, B::kPixels);
        left = std::max(left, B::kPixels);
        out += pixels * B::kChannels;
        at = at + pixels * step;
      }
    }
  }
}

/// A rectangle of output pixels around all blocks of the spans.
template <class B>
bool stays_inside(B blocks, const SourcePlane& source, const AffineMap& map,
                  std::span<const Span> spans) {
  int left = spans.front().x_begin;
  int right = left;
  for (const Span& span : spans) {
    left = std::min(left, span.x_begin);
    right = std::max(right, std::max(span.x_end, span.x_begin + B::kPixels));
  }
  const SafeArea safe = safe_area(blocks, source);
  const int top = spans.front().y;
  const int bottom = spans.back().y;
  return safe.contains(map.at(left, top)) && safe.contains(map.at(right, top)) &&
         safe.contains(map.at(left, bottom)) && safe.contains(map.at(right, bottom));
}

/// Tries vectors of this size, then half of it, and so on.
template <int kVectorBytes, int kChannels>
void paint_from(const SourcePlane& source, const AffineMap& map, std::span<const Span> spans,
                MutablePlane output) {
  if constexpr (kVectorBytes < 16) {
    paint_pixels<kChannels>(source, map, spans, output);
  } else {
    constexpr Blocks<kVectorBytes, kChannels> blocks;
    BlockPlan plan;
    if (plan_block<kChannels>(plan, blocks.kShape, map.per_column)) {
      return stays_inside(blocks, source, map, spans)
                 ? paint_blocks<Reach::inside>(blocks, plan, source, map, spans, output)
                 : paint_blocks<Reach::past_edge>(blocks, plan, source, map, spans, output);
    }
    paint_from<kVectorBytes / 2, kChannels>(source, map, spans, output);
  }
}

template <int kChannels>
void paint(const SourcePlane& source, const AffineMap& map, std::span<const Span> spans,
           MutablePlane output) {
  paint_from<kWidest, kChannels>(source, map, spans, output);
}

#endif

void paint_plane(Plane plane, const SourcePlane& source, const AffineMap& map,
                 std::span<const Span> spans, MutablePlane output) {
  if (plane == Plane::luma) return paint<1>(source, map, spans, output);
  paint<2>(source, map, spans, output);
}

const char* target_name() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace gimbal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace gimbal {
namespace {

HWY_EXPORT(paint_plane);
HWY_EXPORT(target_name);

}  // namespace

void paint_spans(Plane plane, const SourcePlane& source, const AffineMap& map,
                 std::span<const Span> spans, MutablePlane output) {
  HWY_DYNAMIC_DISPATCH(paint_plane)(plane, source, map, spans, output);
}

std::string vector_instructions() {
  return HWY_DYNAMIC_DISPATCH(target_name)();
}

}  // namespace gimbal
#endif  // HWY_ONCE
