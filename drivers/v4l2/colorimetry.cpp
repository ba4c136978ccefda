#include "drivers/v4l2/colorimetry.hpp"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <string>

namespace gimbal {
namespace {

// The numbers on the right are those of GStreamer's caps (GstVideoColorRange,
// GstVideoColorMatrix, GstVideoTransferFunction, GstVideoColorPrimaries); 0 is unknown.

int range_number(std::uint32_t quantization) {
  switch (quantization) {
    case V4L2_QUANTIZATION_FULL_RANGE:
      return 1;
    case V4L2_QUANTIZATION_LIM_RANGE:
      return 2;
    default:
      return 0;
  }
}

int matrix_number(std::uint32_t ycbcr_enc) {
  switch (ycbcr_enc) {
    case V4L2_YCBCR_ENC_709:
    case V4L2_YCBCR_ENC_XV709:
      return 3;
    case V4L2_YCBCR_ENC_601:
    case V4L2_YCBCR_ENC_XV601:
      return 4;
    case V4L2_YCBCR_ENC_SMPTE240M:
      return 5;
    case V4L2_YCBCR_ENC_BT2020:
      return 6;
    default:
      return 0;
  }
}

int transfer_number(std::uint32_t xfer_func) {
  switch (xfer_func) {
    case V4L2_XFER_FUNC_NONE:
      return 1;
    case V4L2_XFER_FUNC_709:
      return 5;
    case V4L2_XFER_FUNC_SMPTE240M:
      return 6;
    case V4L2_XFER_FUNC_SRGB:
      return 7;
    case V4L2_XFER_FUNC_OPRGB:
      return 12;
    case V4L2_XFER_FUNC_SMPTE2084:
      return 14;
    default:
      return 0;
  }
}

int primaries_number(std::uint32_t colorspace) {
  switch (colorspace) {
    case V4L2_COLORSPACE_REC709:
    case V4L2_COLORSPACE_SRGB:
    case V4L2_COLORSPACE_JPEG:
      return 1;
    case V4L2_COLORSPACE_470_SYSTEM_M:
      return 2;
    case V4L2_COLORSPACE_470_SYSTEM_BG:
      return 3;
    case V4L2_COLORSPACE_SMPTE170M:
      return 4;
    case V4L2_COLORSPACE_SMPTE240M:
      return 5;
    case V4L2_COLORSPACE_BT2020:
      return 7;
    case V4L2_COLORSPACE_OPRGB:
      return 8;
    case V4L2_COLORSPACE_DCI_P3:
      return 11;
    default:
      return 0;
  }
}

// What follows from the colour space, by the kernel's own macros.

std::uint32_t transfer_of(std::uint32_t colorspace) {
  return V4L2_MAP_XFER_FUNC_DEFAULT(colorspace);
}

std::uint32_t encoding_of(std::uint32_t colorspace) {
  return V4L2_MAP_YCBCR_ENC_DEFAULT(colorspace);
}

std::uint32_t quantization_of(std::uint32_t colorspace) {
  return V4L2_MAP_QUANTIZATION_DEFAULT(false, colorspace, 0);
}

ColorFields without_defaults(ColorFields fields) {
  if (fields.xfer_func == V4L2_XFER_FUNC_DEFAULT) fields.xfer_func = transfer_of(fields.colorspace);
  if (fields.ycbcr_enc == V4L2_YCBCR_ENC_DEFAULT) fields.ycbcr_enc = encoding_of(fields.colorspace);
  if (fields.quantization == V4L2_QUANTIZATION_DEFAULT) {
    fields.quantization = quantization_of(fields.colorspace);
  }
  return fields;
}

/// The short names of what is common. BT.601 and BT.709 have the same transfer function.
std::string by_name(std::string numbers) {
  if (numbers == "2:3:5:1") return "bt709";
  if (numbers == "2:4:5:4") return "bt601";
  return numbers;
}

}  // namespace

ColorInfo color_info(const ColorFields& fields, ChromaSiting siting) {
  const bool is_known =
      fields.colorspace != V4L2_COLORSPACE_DEFAULT && fields.colorspace != V4L2_COLORSPACE_RAW;
  if (!is_known) return {"", siting};
  const ColorFields full = without_defaults(fields);
  return {by_name(fmt::format("{}:{}:{}:{}", range_number(full.quantization),
                              matrix_number(full.ycbcr_enc), transfer_number(full.xfer_func),
                              primaries_number(full.colorspace))),
          siting};
}

}  // namespace gimbal
