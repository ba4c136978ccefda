// One source for all instruction sets: Highway includes this file again for each of them, and the
// widest that the processor has is chosen when the program runs.

#include "pipeline/warp/span_painter.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "pipeline/warp/span_plan.hpp"
#include "pipeline/warp/span_sampler.hpp"

#define HWY_WANT_AVX3_DL  // lookups in tables of 32 bytes
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/warp/span_painter.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "pipeline/warp/block_samplers-inl.hpp"
#include "pipeline/warp/gathered_spans-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace gimbal {
namespace HWY_NAMESPACE {
namespace {

template <class Kernel, int kChannels>
void paint_pixels(const SourcePlane& source, const AffineMap& map, std::span<const Span> spans,
                  MutablePlane output) {
  for (const Span& span : spans) {
    sample_span<Kernel, kChannels>(
        source, {map.at(span.x_begin, span.y), map.per_column}, span.x_end - span.x_begin,
        output.data + span.y * output.stride_bytes + span.x_begin * kChannels);
  }
}

#if HWY_TARGET == HWY_SCALAR

template <class Kernel, int kChannels>
void paint(const SourcePlane& source, const AffineMap& map, std::span<const Span> spans,
           MutablePlane output) {
  paint_pixels<Kernel, kChannels>(source, map, spans, output);
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

/// Draws spans of which all that the blocks load lies within the source.
template <class B, class Sample>
HWY_INLINE void paint_inside(B blocks, const Sample& sample, const AffineMap& map,
                             std::span<const Span> spans, MutablePlane output) {
  const typename B::Output d_out;
  for (const Span& span : spans) {
    std::uint8_t* out =
        output.data + span.y * output.stride_bytes + std::ptrdiff_t{span.x_begin} * B::kChannels;
    FixedPoint at = map.at(span.x_begin, span.y);
    int left = span.x_end - span.x_begin;
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
      at = at + pixels * map.per_column;
    }
  }
}

/// Draws any spans: where a block reaches past the source, pixel by pixel.
template <class Kernel, class B, class Sample>
HWY_INLINE void paint_anywhere(Kernel kernel, B blocks, const Sample& sample,
                               const SourcePlane& source, const AffineMap& map,
                               std::span<const Span> spans, MutablePlane output) {
  const SafeArea safe = safe_area(kernel, blocks, source);
  const FixedPoint step = map.per_column;
  for (const Span& span : spans) {
    std::uint8_t* out =
        output.data + span.y * output.stride_bytes + std::ptrdiff_t{span.x_begin} * B::kChannels;
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
  }
}

/// A rectangle of output pixels around all blocks of the spans.
template <class Kernel, class B>
bool stays_inside(Kernel kernel, B blocks, const SourcePlane& source, const AffineMap& map,
                  std::span<const Span> spans) {
  int left = spans.front().x_begin;
  int right = left;
  for (const Span& span : spans) {
    left = std::min(left, span.x_begin);
    right = std::max(right, std::max(span.x_end, span.x_begin + B::kPixels));
  }
  const SafeArea safe = safe_area(kernel, blocks, source);
  const int top = spans.front().y;
  const int bottom = spans.back().y;
  return safe.contains(map.at(left, top)) && safe.contains(map.at(right, top)) &&
         safe.contains(map.at(left, bottom)) && safe.contains(map.at(right, bottom));
}

/// Tries vectors of this size, then half of it, and so on; then what needs no level walk.
template <class Kernel, int kVectorBytes, int kChannels>
void paint_from(const SourcePlane& source, const AffineMap& map, std::span<const Span> spans,
                MutablePlane output) {
  if constexpr (kVectorBytes < 16) {
    if constexpr (std::is_same_v<Kernel, BilinearKernel>) {
      if (fits_gathered(map.per_column)) {
        return paint_gathered<kChannels>(source, map, spans, output);
      }
    }
    paint_pixels<Kernel, kChannels>(source, map, spans, output);
  } else {
    constexpr Kernel kernel;
    constexpr Blocks<kVectorBytes, kChannels> blocks;
    BlockPlan plan;
    if (!plan_block<Kernel, kChannels>(plan, blocks.kShape, map.per_column)) {
      return paint_from<Kernel, kVectorBytes / 2, kChannels>(source, map, spans, output);
    }
    const bool is_inside = stays_inside(kernel, blocks, source, map, spans);
    with_sampler(kernel, blocks, plan, source, [&](const auto& sample) HWY_ATTR {
      if (is_inside) return paint_inside(blocks, sample, map, spans, output);
      paint_anywhere(kernel, blocks, sample, source, map, spans, output);
    });
  }
}

template <class Kernel, int kChannels>
void paint(const SourcePlane& source, const AffineMap& map, std::span<const Span> spans,
           MutablePlane output) {
  paint_from<Kernel, kWidest, kChannels>(source, map, spans, output);
}

#endif

void paint_plane(Plane plane, Interpolation interpolation, const SourcePlane& source,
                 const AffineMap& map, std::span<const Span> spans, MutablePlane output) {
  with_kernel(interpolation, [&](auto kernel) {
    using Kernel = decltype(kernel);
    if (plane == Plane::luma) return paint<Kernel, 1>(source, map, spans, output);
    paint<Kernel, 2>(source, map, spans, output);
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

void paint_spans(Plane plane, Interpolation interpolation, const SourcePlane& source,
                 const AffineMap& map, std::span<const Span> spans, MutablePlane output) {
  HWY_DYNAMIC_DISPATCH(paint_plane)(plane, interpolation, source, map, spans, output);
}

std::string vector_instructions() {
  return HWY_DYNAMIC_DISPATCH(target_name)();
}

}  // namespace gimbal
#endif  // HWY_ONCE
