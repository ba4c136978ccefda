#include "pipeline/pixels/nv12_conversion.hpp"

#include <algorithm>
#include <cstring>

namespace gimbal {
namespace {

constexpr std::uint8_t kNoChroma = 128;

const std::uint8_t* row_of(ConstPlane plane, int row) {
  return plane.data + row * plane.stride_bytes;
}

std::uint8_t* row_of(MutablePlane plane, int row) {
  return plane.data + row * plane.stride_bytes;
}

void copy_rows(ConstPlane source, MutablePlane target, int row_bytes, int rows) {
  for (int row = 0; row < rows; ++row) {
    std::memcpy(row_of(target, row), row_of(source, row), static_cast<std::size_t>(row_bytes));
  }
}

std::uint8_t average(int a, int b) {
  return static_cast<std::uint8_t>((a + b + 1) / 2);
}

std::uint8_t average(int a, int b, int c, int d) {
  return static_cast<std::uint8_t>((a + b + c + d + 2) / 4);
}

void interleave_row(const std::uint8_t* u, const std::uint8_t* v, int pairs, std::uint8_t* out) {
  for (std::ptrdiff_t x = 0; x < pairs; ++x) {
    out[2 * x] = u[x];
    out[2 * x + 1] = v[x];
  }
}

/// One of the two chroma channels of a picture that has more of them than NV12.
void average_channel(ConstPlane source, ImageSize source_size, ChromaShare share, Nv12Buffer& to,
                     int channel) {
  const ImageSize chroma = chroma_size(to.size());
  for (int y = 0; y < chroma.height; ++y) {
    const std::uint8_t* upper = row_of(source, y * share.down);
    const std::uint8_t* lower =
        row_of(source, std::min((y + 1) * share.down, source_size.height) - 1);
    std::uint8_t* out = row_of(to.chroma(), y) + channel;
    for (int x = 0; x < chroma.width; ++x) {
      const int left = x * share.across;
      const int right = std::min((x + 1) * share.across, source_size.width) - 1;
      out[std::ptrdiff_t{2} * x] = average(upper[left], upper[right], lower[left], lower[right]);
    }
  }
}

/// Where the bytes lie in a group of two pixels.
struct GroupLayout {
  int luma;    ///< of the left pixel; the right one's is two bytes on
  int chroma;  ///< U; V is two bytes on
};

GroupLayout layout_of(Packing422 packing) {
  return packing == Packing422::yuyv ? GroupLayout{0, 1} : GroupLayout{1, 0};
}

/// Weights of BT.601 in units of 1/65536, each row's sum exact: 65536 for luma, 0 for chroma.
struct RgbWeights {
  int r, g, b;
};
constexpr RgbWeights kLuma = {19595, 38470, 7471};
constexpr RgbWeights kCb = {-11058, -21710, 32768};
constexpr RgbWeights kCr = {32768, -27439, -5329};

struct Rgb {
  int r, g, b;
};

Rgb pixel_at(const std::uint8_t* row, int x, RgbOrder order) {
  const std::uint8_t* pixel = row + std::ptrdiff_t{3} * x;
  return order == RgbOrder::rgb ? Rgb{pixel[0], pixel[1], pixel[2]}
                                : Rgb{pixel[2], pixel[1], pixel[0]};
}

std::uint8_t weighted(const Rgb& sum, const RgbWeights& weights, int samples, int offset) {
  const int unit = 65536 * samples;
  const int value = weights.r * sum.r + weights.g * sum.g + weights.b * sum.b + offset * unit;
  return static_cast<std::uint8_t>(std::clamp((value + unit / 2) / unit, 0, 255));
}

Rgb sum_of_block(const std::uint8_t* upper, const std::uint8_t* lower, int left, int right,
                 RgbOrder order) {
  Rgb sum{};
  for (const std::uint8_t* row : {upper, lower}) {
    for (const int x : {left, right}) {
      const Rgb pixel = pixel_at(row, x, order);
      sum = {sum.r + pixel.r, sum.g + pixel.g, sum.b + pixel.b};
    }
  }
  return sum;
}

}  // namespace

void copy_nv12(const std::array<ConstPlane, 2>& source, Nv12Buffer& picture) {
  const ImageSize size = picture.size();
  const ImageSize chroma = chroma_size(size);
  copy_rows(source[0], picture.luma(), size.width, size.height);
  copy_rows(source[1], picture.chroma(), 2 * chroma.width, chroma.height);
}

void interleave_chroma(ConstPlane u, ConstPlane v, ImageSize size, MutablePlane out) {
  for (int y = 0; y < size.height; ++y) {
    interleave_row(row_of(u, y), row_of(v, y), size.width, row_of(out, y));
  }
}

void convert_planar(const std::array<ConstPlane, 3>& source, ChromaShare share,
                    Nv12Buffer& picture) {
  const ImageSize size = picture.size();
  const ImageSize chroma = chroma_size(size);
  copy_rows(source[0], picture.luma(), size.width, size.height);
  if (share.across == 1 && share.down == 1) {
    return interleave_chroma(source[1], source[2], chroma, picture.chroma());
  }
  const ImageSize source_size = {share.across == 1 ? chroma.width : size.width,
                                 share.down == 1 ? chroma.height : size.height};
  average_channel(source[1], source_size, share, picture, 0);
  average_channel(source[2], source_size, share, picture, 1);
}

void convert_packed_422(ConstPlane source, Packing422 packing, Nv12Buffer& picture) {
  const ImageSize size = picture.size();
  const ImageSize chroma = chroma_size(size);
  const GroupLayout layout = layout_of(packing);
  for (int y = 0; y < size.height; ++y) {
    const std::uint8_t* in = row_of(source, y) + layout.luma;
    std::uint8_t* out = row_of(picture.luma(), y);
    for (std::ptrdiff_t x = 0; x < size.width; ++x) out[x] = in[2 * x];
  }
  for (int y = 0; y < chroma.height; ++y) {
    const std::uint8_t* upper = row_of(source, 2 * y) + layout.chroma;
    const std::uint8_t* lower =
        row_of(source, std::min(2 * y + 1, size.height - 1)) + layout.chroma;
    std::uint8_t* out = row_of(picture.chroma(), y);
    for (std::ptrdiff_t x = 0; x < std::ptrdiff_t{2} * chroma.width; ++x)
      out[x] = average(upper[2 * x], lower[2 * x]);
  }
}

void convert_grey(ConstPlane source, Nv12Buffer& picture) {
  const ImageSize size = picture.size();
  const ImageSize chroma = chroma_size(size);
  copy_rows(source, picture.luma(), size.width, size.height);
  for (int y = 0; y < chroma.height; ++y) {
    std::memset(row_of(picture.chroma(), y), kNoChroma, 2 * static_cast<std::size_t>(chroma.width));
  }
}

void convert_rgb(ConstPlane source, RgbOrder order, Nv12Buffer& picture) {
  const ImageSize size = picture.size();
  const ImageSize chroma = chroma_size(size);
  for (int y = 0; y < size.height; ++y) {
    const std::uint8_t* in = row_of(source, y);
    std::uint8_t* out = row_of(picture.luma(), y);
    for (int x = 0; x < size.width; ++x) out[x] = weighted(pixel_at(in, x, order), kLuma, 1, 0);
  }
  for (int y = 0; y < chroma.height; ++y) {
    const std::uint8_t* upper = row_of(source, 2 * y);
    const std::uint8_t* lower = row_of(source, std::min(2 * y + 1, size.height - 1));
    std::uint8_t* out = row_of(picture.chroma(), y);
    for (int x = 0; x < chroma.width; ++x) {
      const Rgb sum = sum_of_block(upper, lower, 2 * x, std::min(2 * x + 1, size.width - 1), order);
      std::uint8_t* pair = out + std::ptrdiff_t{2} * x;
      pair[0] = weighted(sum, kCb, 4, 128);
      pair[1] = weighted(sum, kCr, 4, 128);
    }
  }
}

}  // namespace gimbal
