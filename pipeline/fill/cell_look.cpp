#include "pipeline/fill/cell_look.hpp"

#include <cstdint>

namespace gimbal {
namespace {

constexpr int kHalfPx = CellGrid::kCellPx / 2;

const std::uint8_t* row_of(const ConstPlane& plane, int y) {
  return plane.data + y * plane.stride_bytes;
}

}  // namespace

CellLook look_at(const PicturePlanes& picture, const CellGrid& grid, CellPlace cell) {
  const PixelBox box = grid.pixels(cell);
  std::array<int, 4> luma{};
  std::array<int, 2> chroma{};
  for (int y = 0; y < CellGrid::kCellPx; ++y) {
    const std::uint8_t* row = row_of(picture[0], box.y_begin + y) + box.x_begin;
    const std::size_t upper = y < kHalfPx ? 0 : 2;
    for (int x = 0; x < kHalfPx; ++x) {
      luma[upper] += row[x];
      luma[upper + 1] += row[kHalfPx + x];
    }
  }
  for (int y = 0; y < kHalfPx; ++y) {
    const std::uint8_t* row = row_of(picture[1], box.y_begin / 2 + y) + box.x_begin;
    for (int x = 0; x < kHalfPx; ++x) {
      chroma[0] += row[2 * x];
      chroma[1] += row[2 * x + 1];
    }
  }
  constexpr float kShare = 1.0F / (kHalfPx * kHalfPx);
  CellLook look;
  for (std::size_t i = 0; i < 4; ++i) look.luma[i] = kShare * static_cast<float>(luma[i]);
  for (std::size_t i = 0; i < 2; ++i) look.chroma[i] = kShare * static_cast<float>(chroma[i]);
  return look;
}

bool is_whole(const CellGrid& grid, CellPlace cell) {
  const PixelBox box = grid.pixels(cell);
  return box.x_end - box.x_begin == CellGrid::kCellPx &&
         box.y_end - box.y_begin == CellGrid::kCellPx;
}

}  // namespace gimbal
