#include "daemon/no_signal.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

namespace gimbal {
namespace {

// Levels inside the narrow range, so that they are plain in either range.
constexpr std::uint8_t kGrey = 64;
constexpr std::uint8_t kWhite = 220;
constexpr std::uint8_t kNoColor = 128;

/// Dots of the words, a row a line.
constexpr std::array<std::string_view, 5> kWords = {
    "#   #  ###    ####  #  ####  #   #   ##   #   ",
    "##  # #   #  #      # #      ##  #  #  #  #   ",
    "# # # #   #   ###   # #  ##  # # #  ####  #   ",
    "#  ## #   #      #  # #   #  #  ##  #  #  #   ",
    "#   #  ###   ####   #  ####  #   #  #  #  ####",
};

void fill(const MutablePlane& plane, int rows, int row_bytes, std::uint8_t level) {
  for (int y = 0; y < rows; ++y) std::fill_n(plane.data + y * plane.stride_bytes, row_bytes, level);
}

void draw_words(const MutablePlane& luma, ImageSize size) {
  const int columns = static_cast<int>(kWords.front().size());
  const int rows = static_cast<int>(kWords.size());
  const int dot = size.width / (2 * columns);
  const int left = (size.width - dot * columns) / 2;
  const int top = (size.height - dot * rows) / 2;
  if (dot == 0 || top < 0) return;
  for (int y = 0; y < dot * rows; ++y) {
    const std::string_view row = kWords[static_cast<std::size_t>(y / dot)];
    std::uint8_t* line = luma.data + (top + y) * luma.stride_bytes + left;
    for (int x = 0; x < dot * columns; ++x) {
      if (row[static_cast<std::size_t>(x / dot)] == '#') line[x] = kWhite;
    }
  }
}

}  // namespace

VideoFrame no_signal_picture(ImageSize size, const ColorInfo& color) {
  Nv12Buffer picture(size);
  const ImageSize chroma = chroma_size(size);
  fill(picture.luma(), size.height, size.width, kGrey);
  fill(picture.chroma(), chroma.height, 2 * chroma.width, kNoColor);
  draw_words(picture.luma(), size);
  return std::move(picture).publish(FrameStamp{}, color);
}

}  // namespace gimbal
