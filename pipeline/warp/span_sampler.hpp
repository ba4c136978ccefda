#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "pipeline/warp/interpolation.hpp"
#include "pipeline/warp/span.hpp"

namespace gimbal {

/// Where the neighbours of a point lie in memory, for each rule of what is past the edge.
struct ClampToEdge {
  static int index(int i, int length) { return std::clamp(i, 0, length - 1); }
};

/// As GL_MIRRORED_REPEAT: the outermost pixel is doubled.
struct MirrorAtEdge {
  static int index(int i, int length) {
    const int period = 2 * length;
    const int in_period = ((i % period) + period) % period;
    return std::min(in_period, period - 1 - in_period);
  }
};

/// The 15 bits of a coordinate's fraction that kernels take.
constexpr int kernel_fraction(FixedPx px) {
  return static_cast<int>((px & (kOnePx - 1)) >> (kFixedPxFractionBits - 15));
}

/// Samples along a walk, one pixel after the other; kChannels bytes a pixel. Any walk will do,
/// wherever it leads.
template <typename Kernel, typename Edge, int kChannels>
void sample_span(const SourcePlane& source, SourceWalk walk, int pixels, std::uint8_t* out) {
  constexpr int kOne = kTapWeightOne * kTapWeightOne;
  FixedPoint at = walk.start;
  for (int i = 0; i < pixels; ++i, at = at + walk.step) {
    const auto across = Kernel::weights(kernel_fraction(at.x));
    const auto down = Kernel::weights(kernel_fraction(at.y));
    std::array<int, static_cast<std::size_t>(kChannels)> sums{};
    for (int row = 0; row < Kernel::kTaps; ++row) {
      const int y = Edge::index(whole_px(at.y) + row - Kernel::kTapsBefore, source.size.height);
      const std::uint8_t* line = source.memory.data + y * source.memory.stride_bytes;
      for (int column = 0; column < Kernel::kTaps; ++column) {
        const int x = Edge::index(whole_px(at.x) + column - Kernel::kTapsBefore, source.size.width);
        const int weight =
            across[static_cast<std::size_t>(column)] * down[static_cast<std::size_t>(row)];
        for (int channel = 0; channel < kChannels; ++channel) {
          sums[static_cast<std::size_t>(channel)] += weight * line[x * kChannels + channel];
        }
      }
    }
    for (const int sum : sums) {
      *out++ = static_cast<std::uint8_t>(std::clamp((sum + kOne / 2) / kOne, 0, 255));
    }
  }
}

/// The same with the border's own rule.
template <typename Kernel, int kChannels>
void sample_span(const SourcePlane& source, const SourceWalk& walk, int pixels, std::uint8_t* out) {
  const auto sample = source.border == Border::mirror
                          ? &sample_span<Kernel, MirrorAtEdge, kChannels>
                          : &sample_span<Kernel, ClampToEdge, kChannels>;
  sample(source, walk, pixels, out);
}

}  // namespace gimbal
