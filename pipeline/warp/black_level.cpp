#include "pipeline/warp/black_level.hpp"

namespace gimbal {
namespace {

// GStreamer writes either a name or range:matrix:transfer:primaries in numbers, where range 1 is
// 0..255 (GstVideoColorRange). Of the names only sRGB has the full range.
bool is_full_range(const std::string& colorimetry) {
  return colorimetry.starts_with("1:") || colorimetry == "sRGB";
}

}  // namespace

BlackLevel black_level(const ColorInfo& color) {
  const std::uint8_t luma = is_full_range(color.colorimetry) ? 0 : 16;
  return {luma, {128, 128}};
}

}  // namespace gimbal
