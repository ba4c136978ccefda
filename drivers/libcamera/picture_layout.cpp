#include "drivers/libcamera/picture_layout.hpp"

#include <fmt/format.h>

#include "pipeline/pixels/nv12_conversion.hpp"

namespace gimbal {
namespace {

using libcamera::ColorSpace;

// GStreamer's numbers; 0 is unknown.

int range_number(ColorSpace::Range range) {
  return range == ColorSpace::Range::Full ? 1 : 2;
}

int matrix_number(ColorSpace::YcbcrEncoding encoding) {
  switch (encoding) {
    case ColorSpace::YcbcrEncoding::None:
      return 1;
    case ColorSpace::YcbcrEncoding::Rec709:
      return 3;
    case ColorSpace::YcbcrEncoding::Rec601:
      return 4;
    case ColorSpace::YcbcrEncoding::Rec2020:
      return 6;
  }
  return 0;
}

int transfer_number(ColorSpace::TransferFunction transfer) {
  switch (transfer) {
    case ColorSpace::TransferFunction::Linear:
      return 1;
    case ColorSpace::TransferFunction::Rec709:
      return 5;
    case ColorSpace::TransferFunction::Srgb:
      return 7;
  }
  return 0;
}

int primaries_number(ColorSpace::Primaries primaries) {
  switch (primaries) {
    case ColorSpace::Primaries::Raw:
      return 0;
    case ColorSpace::Primaries::Rec709:
      return 1;
    case ColorSpace::Primaries::Smpte170m:
      return 4;
    case ColorSpace::Primaries::Rec2020:
      return 7;
  }
  return 0;
}

PlaneExtent extent(std::ptrdiff_t stride_bytes, int row_bytes, int rows) {
  return {stride_bytes, static_cast<std::size_t>(stride_bytes * (rows - 1) + row_bytes)};
}

}  // namespace

const std::vector<KnownLibcameraFormat>& known_libcamera_formats() {
  static const std::vector<KnownLibcameraFormat> formats = {
      {libcamera::formats::NV12, LibcameraLayout::nv12, "NV12"},
      {libcamera::formats::YUV420, LibcameraLayout::yuv420, "YUV420"},
      {libcamera::formats::RGB888, LibcameraLayout::bgr_bytes, "RGB888"},
      {libcamera::formats::BGR888, LibcameraLayout::rgb_bytes, "BGR888"},
  };
  return formats;
}

std::optional<NativeFormat> native_format(LibcameraLayout layout) {
  switch (layout) {
    case LibcameraLayout::nv12:
      return std::nullopt;
    case LibcameraLayout::yuv420:
      return NativeFormat::i420;
    case LibcameraLayout::bgr_bytes:
      return NativeFormat::bgr;
    case LibcameraLayout::rgb_bytes:
      return NativeFormat::rgb;
  }
  return std::nullopt;
}

std::string colorimetry_of(const std::optional<ColorSpace>& space) {
  if (!space || space->primaries == ColorSpace::Primaries::Raw) return {};
  std::string numbers =
      fmt::format("{}:{}:{}:{}", range_number(space->range), matrix_number(space->ycbcrEncoding),
                  transfer_number(space->transferFunction), primaries_number(space->primaries));
  if (numbers == "2:3:5:1") return "bt709";
  if (numbers == "2:4:5:4") return "bt601";
  return numbers;
}

ColorInfo color_of(LibcameraLayout layout, const std::optional<ColorSpace>& space) {
  const bool is_rgb = layout == LibcameraLayout::bgr_bytes || layout == LibcameraLayout::rgb_bytes;
  if (is_rgb) return {"1:4:7:1", ChromaSiting::center};
  return {colorimetry_of(space), ChromaSiting::left};
}

std::vector<PlaneExtent> extents_of(const LibcameraPictures& pictures) {
  const ImageSize size = pictures.size;
  const ImageSize chroma = chroma_size(size);
  const std::ptrdiff_t stride = pictures.stride_bytes;
  switch (pictures.layout) {
    case LibcameraLayout::nv12:
      return {extent(stride, size.width, size.height),
              extent(stride, 2 * chroma.width, chroma.height)};
    case LibcameraLayout::yuv420:
      return {extent(stride, size.width, size.height),
              extent(stride / 2, chroma.width, chroma.height),
              extent(stride / 2, chroma.width, chroma.height)};
    case LibcameraLayout::bgr_bytes:
    case LibcameraLayout::rgb_bytes:
      return {extent(stride, 3 * size.width, size.height)};
  }
  return {};
}

Nv12Buffer converted(const LibcameraPictures& pictures, const std::vector<ConstPlane>& planes) {
  Nv12Buffer picture(pictures.size);
  switch (pictures.layout) {
    case LibcameraLayout::nv12:
      copy_nv12({planes[0], planes[1]}, picture);
      break;
    case LibcameraLayout::yuv420:
      convert_planar({planes[0], planes[1], planes[2]}, {1, 1}, picture);
      break;
    case LibcameraLayout::bgr_bytes:
      convert_rgb(planes[0], RgbOrder::bgr, picture);
      break;
    case LibcameraLayout::rgb_bytes:
      convert_rgb(planes[0], RgbOrder::rgb, picture);
      break;
  }
  return picture;
}

}  // namespace gimbal
