#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

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

/// Bilinear samples along a walk, one pixel after the other; kChannels bytes a pixel. Any walk will
/// do, wherever it leads.
template <typename Edge, int kChannels>
void sample_span(const SourcePlane& source, SourceWalk walk, int pixels, std::uint8_t* out) {
  constexpr int kWeightBits = 11;  // 8 bits of picture and two weights of 11 bits fit an int
  constexpr int kWeightOne = 1 << kWeightBits;
  constexpr int kHalf = 1 << (2 * kWeightBits - 1);
  const auto weight = [](FixedPx px) {
    return static_cast<int>(px >> (kFixedPxFractionBits - kWeightBits)) & (kWeightOne - 1);
  };
  const auto mix = [](int a, int b, int weight_b) {
    return a * (kWeightOne - weight_b) + b * weight_b;
  };
  const auto row = [&](int y) {
    return source.memory.data + Edge::index(y, source.size.height) * source.memory.stride_bytes;
  };
  FixedPoint at = walk.start;
  for (int i = 0; i < pixels; ++i, at = at + walk.step) {
    const int left = Edge::index(whole_px(at.x), source.size.width) * kChannels;
    const int right = Edge::index(whole_px(at.x) + 1, source.size.width) * kChannels;
    const std::uint8_t* upper = row(whole_px(at.y));
    const std::uint8_t* lower = row(whole_px(at.y) + 1);
    for (int channel = 0; channel < kChannels; ++channel, ++out) {
      const int above = mix(upper[left + channel], upper[right + channel], weight(at.x));
      const int below = mix(lower[left + channel], lower[right + channel], weight(at.x));
      *out =
          static_cast<std::uint8_t>((mix(above, below, weight(at.y)) + kHalf) >> (2 * kWeightBits));
    }
  }
}

/// The same with the border's own rule.
template <int kChannels>
void sample_span(const SourcePlane& source, const SourceWalk& walk, int pixels, std::uint8_t* out) {
  const auto sample = source.border == Border::mirror ? &sample_span<MirrorAtEdge, kChannels>
                                                      : &sample_span<ClampToEdge, kChannels>;
  sample(source, walk, pixels, out);
}

}  // namespace gimbal
