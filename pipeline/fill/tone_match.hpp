#pragma once

#include <array>
#include <vector>

#include "pipeline/fill/cell_look.hpp"

namespace gimbal {

/// How the tones of one picture are brought to those of another: luma about black by a gain, then
/// an offset; chroma about grey by the same gain, then offsets.
struct Tone {
  float black = 16;
  float gain = 1;
  float luma_offset = 0;
  std::array<float, 2> chroma_offset{};

  [[nodiscard]] float luma(float value) const {
    return black + gain * (value - black) + luma_offset;
  }
  [[nodiscard]] float chroma(float value, std::size_t channel) const {
    return 128 + gain * (value - 128) + chroma_offset[channel];
  }
};

/// The same cell in two pictures.
struct CellPair {
  CellLook wanted;
  CellLook given;
};

/// Brings `given` to `wanted` where both show the same; cells that differ otherwise count little
/// (iteratively reweighted least squares). `black` is the luma of black. Where cells are too few or
/// too even to tell gain from offset, it is taken for a gain.
[[nodiscard]] Tone match_tones(const std::vector<CellPair>& pairs, float black);

}  // namespace gimbal
