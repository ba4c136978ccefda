#pragma once

#include <cstdint>

#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// The fields of v4l2_pix_format and v4l2_pix_format_mplane that tell how colours are coded.
struct ColorFields {
  std::uint32_t colorspace = 0;
  std::uint32_t ycbcr_enc = 0;
  std::uint32_t quantization = 0;
  std::uint32_t xfer_func = 0;
};

/// Fields that are left at their default follow from the colour space
/// (userspace-api/media/v4l/colorspaces-defs.rst).
[[nodiscard]] ColorInfo color_info(const ColorFields& fields, ChromaSiting siting);

}  // namespace gimbal
