#pragma once

#include <array>
#include <cstdint>

#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Black as NV12 has it.
struct BlackLevel {
  std::uint8_t luma;
  std::array<std::uint8_t, 2> chroma;  ///< U, V
};

/// Luma 0 where the colorimetry says full range, else 16, video's usual range.
[[nodiscard]] BlackLevel black_level(const ColorInfo& color);

}  // namespace gimbal
