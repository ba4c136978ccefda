// One source for all instruction sets: Highway includes this file again for each of them, and the
// widest that the processor has is chosen when the program runs.

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
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "pipeline/warp/block_samplers-inl.hpp"
#include "pipeline/warp/gathered_spans-inl.hpp"
#include "pipeline/warp/trapezoid_rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace gimbal {
namespace HWY_NAMESPACE {
namespace {

template <class Kernel, int kChannels>
void paint_pixels(const SourcePlane& source, const AffineMap& map, std::span<const Trapezoid> area,
                  const OutputPlane& output) {
  for_each_row(area, output.width, [&](const Span& span) {
    sample_span<Kernel, kChannels>(source, {map.at(span.x_begin, span.y), map.per_column},
                                   span.x_end - span.x_begin,
                                   output.at<kChannels>(span.x_begin, span.y));
  });
}

#if HWY_TARGET == HWY_SCALAR

template <class Kernel, int kChannels>
void paint(const SourcePlane& source, const AffineMap& map, std::span<const Trapezoid> area,
           const OutputPlane& output) {
  paint_pixels<Kernel, kChannels>(source, map, area, output);
}

#else

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

template <class Kernel, class B>
SafeArea<Kernel> safe_area(Kernel, B, const SourcePlane& source) {
  return {source.size, B::kShape.table_bytes / B::kChannels};
}

/// Draws where all that the blocks load lies within the source.
template <class B, class Sample>
HWY_INLINE void paint_inside(B blocks, const Sample& sample, const AffineMap& map,
                             std::span<const Trapezoid> area, const OutputPlane& output) {
  const typename B::Output d_out;
  for_each_row(
      area, output.width, [&](const Span& span) HWY_ATTR __attribute__((always_inline)) {
        std::uint8_t* out = output.at<B::kChannels>(span.x_begin, span.y);
        FixedPoint at = map.at(span.x_begin, span.y);
        int left = span.x_end - span.x_begin;
        if (left < B::kPixels) return store_some(blocks, sample(at), left * B::kChannels, out);
        while (true) {
          hwy::Prefetch(out + kRowsAhead * output.memory.stride_bytes);
          hn::StoreU(sample(at), d_out, out);
          left -= B::kPixels;
          if (left <= 0) break;
          // The last block draws a part of the one before again, rather than less than a block.
          const int pixels = std::min(left, B::kPixels);
          left = std::max(left, B::kPixels);
          out += pixels * B::kChannels;
          at = at + pixels * map.per_column;
        }
      });
}

/// Draws anywhere: where a block reaches past the source, pixel by pixel.
template <class Kernel, class B, class Sample>
HWY_INLINE void paint_anywhere(Kernel kernel, B blocks, const Sample& sample,
                               const SourcePlane& source, const AffineMap& map,
                               std::span<const Trapezoid> area, const OutputPlane& output) {
  const SafeArea safe = safe_area(kernel, blocks, source);
  const FixedPoint step = map.per_column;
  for_each_row(
      area, output.width, [&](const Span& span) HWY_ATTR __attribute__((always_inline)) {
        std::uint8_t* out = output.at<B::kChannels>(span.x_begin, span.y);
        FixedPoint at = map.at(span.x_begin, span.y);
        for (int left = span.x_end - span.x_begin; left > 0; left -= B::kPixels) {
          const int pixels = std::min(left, B::kPixels);
          if (safe.contains(at) && safe.contains(at + (B::kPixels - 1) * step)) {
            store_some(blocks, sample(at), pixels * B::kChannels, out);
          } else {
            sample_span<Kernel, B::kChannels>(source, {at, step}, pixels, out);
          }
          out += B::kPixels * B::kChannels;
          at = at + B::kPixels * step;
        }
      });
}

/// Whether all that the blocks load lies within the source.
template <class Kernel, class B>
bool stays_inside(Kernel kernel, B blocks, const SourcePlane& source, const AffineMap& map,
                  std::span<const Trapezoid> area, int width) {
  const SafeArea safe = safe_area(kernel, blocks, source);
  const auto row_is_safe = [&](const Span& span) {
    const int x_end = std::max(span.x_end, span.x_begin + B::kPixels);
    return safe.contains(map.at(span.x_begin, span.y)) && safe.contains(map.at(x_end, span.y));
  };
  return std::all_of(area.begin(), area.end(), [&](const Trapezoid& part) {
    return part.rows().empty() || (row_is_safe(part.top(width)) && row_is_safe(part.bottom(width)));
  });
}

/// Tries vectors of this size, then half of it, and so on; then what needs no level walk.
template <class Kernel, int kVectorBytes, int kChannels>
void paint_from(const SourcePlane& source, const AffineMap& map, std::span<const Trapezoid> area,
                const OutputPlane& output) {
  if constexpr (kVectorBytes < 16) {
    if (fits_gathered(map.per_column)) {
      return paint_gathered<Kernel, kChannels>(source, map, area, output);
    }
    paint_pixels<Kernel, kChannels>(source, map, area, output);
  } else {
    constexpr Kernel kernel;
    constexpr Blocks<kVectorBytes, kChannels> blocks;
    BlockPlan plan{};
    if (!plan_block<Kernel, kChannels>(plan, blocks.kShape, map.per_column)) {
      return paint_from<Kernel, kVectorBytes / 2, kChannels>(source, map, area, output);
    }
    const bool is_inside = stays_inside(kernel, blocks, source, map, area, output.width);
    with_sampler(kernel, blocks, plan, source, [&](const auto& sample) HWY_ATTR {
      if (is_inside) return paint_inside(blocks, sample, map, area, output);
      paint_anywhere(kernel, blocks, sample, source, map, area, output);
    });
  }
}

template <class Kernel, int kChannels>
void paint(const SourcePlane& source, const AffineMap& map, std::span<const Trapezoid> area,
           const OutputPlane& output) {
  paint_from<Kernel, kWidest, kChannels>(source, map, area, output);
}

#endif

void paint_plane(Plane plane, Interpolation interpolation, const SourcePlane& source,
                 const AffineMap& map, std::span<const Trapezoid> area, const OutputPlane& output) {
  with_kernel(interpolation, [&](auto kernel) {
    using Kernel = decltype(kernel);
    if (plane == Plane::luma) return paint<Kernel, 1>(source, map, area, output);
    paint<Kernel, 2>(source, map, area, output);
  });
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

void paint_area(Plane plane, Interpolation interpolation, const SourcePlane& source,
                const AffineMap& map, std::span<const Trapezoid> area, const OutputPlane& output) {
  HWY_DYNAMIC_DISPATCH(paint_plane)(plane, interpolation, source, map, area, output);
}

std::string vector_instructions() {
  return HWY_DYNAMIC_DISPATCH(target_name)();
}

}  // namespace gimbal
#endif  // HWY_ONCE
