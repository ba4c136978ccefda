#include "drivers/v4l2/mjpeg_decoder.hpp"

#include <turbojpeg.h>

#include <array>
#include <cstddef>

#include "pipeline/pixels/nv12_conversion.hpp"

namespace gimbal {
namespace {

/// Whether the marker that ends a picture (EOI) is there; the decoder would fill up with grey what
/// a transfer has cut off.
bool is_whole(std::span<const std::uint8_t> jpeg) {
  constexpr std::uint8_t kMarker = 0xFF;
  constexpr std::uint8_t kEndOfImage = 0xD9;
  for (std::size_t i = jpeg.size(); i >= 2; --i) {
    if (jpeg[i - 2] == kMarker && jpeg[i - 1] == kEndOfImage) return true;
  }
  return false;
}

std::optional<ChromaShare> share_of(int subsampling) {
  switch (subsampling) {
    case TJSAMP_420:
      return ChromaShare{1, 1};
    case TJSAMP_422:
      return ChromaShare{1, 2};
    case TJSAMP_440:
      return ChromaShare{2, 1};
    case TJSAMP_444:
      return ChromaShare{2, 2};
    default:
      return std::nullopt;
  }
}

}  // namespace

MjpegDecoder::MjpegDecoder() : handle_(tjInitDecompress(), tjDestroy) {}

std::optional<Nv12Buffer> MjpegDecoder::decode(std::span<const std::uint8_t> jpeg, ImageSize size) {
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colorspace = 0;
  const bool is_readable = handle_ && is_whole(jpeg) &&
                           tjDecompressHeader3(handle_.get(), jpeg.data(), jpeg.size(), &width,
                                               &height, &subsampling, &colorspace) == 0;
  if (!is_readable || ImageSize{width, height} != size) return std::nullopt;
  const auto share = share_of(subsampling);
  const bool is_grey = subsampling == TJSAMP_GRAY;
  if (!share && !is_grey) return std::nullopt;

  std::array<int, 3> strides{};
  std::array<std::size_t, 3> offsets{};
  std::size_t bytes = 0;
  for (int i = 0; i < (is_grey ? 1 : 3); ++i) {
    const auto plane = static_cast<std::size_t>(i);
    strides[plane] = tjPlaneWidth(i, width, subsampling);
    offsets[plane] = bytes;
    bytes += tjPlaneSizeYUV(i, width, 0, height, subsampling);
  }
  planes_.resize(bytes);
  std::array<unsigned char*, 3> data{};
  std::array<ConstPlane, 3> planes{};
  for (std::size_t i = 0; i < 3; ++i) {
    data[i] = planes_.data() + offsets[i];
    planes[i] = {data[i], strides[i]};
  }
  const int status = tjDecompressToYUVPlanes(handle_.get(), jpeg.data(), jpeg.size(), data.data(),
                                             width, strides.data(), height, 0);
  if (status != 0 && tjGetErrorCode(handle_.get()) != TJERR_WARNING) return std::nullopt;

  Nv12Buffer picture(size);
  if (is_grey) {
    convert_grey(planes[0], picture);
  } else {
    convert_planar(planes, *share, picture);
  }
  return picture;
}

}  // namespace gimbal
