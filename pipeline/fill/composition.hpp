#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/fill/cell_grid.hpp"
#include "pipeline/fill/neighbour_fit.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// A picture that is being filled from its edges outward. Keeps its memory from one picture to the
/// next.
class Composition {
 public:
  /// How far inside of its edge a picture of that size is compared to its neighbours, in pixels.
  [[nodiscard]] static float reach_px(ImageSize picture);

  /// `picture` shows something where `depth_px` is above zero (`frame_depth`, held at the reach or
  /// beyond). `black` is the luma of black.
  void begin(Nv12Buffer picture, float black, NodeField depth_px);

  [[nodiscard]] const CellGrid& grid() const { return grid_; }

  /// Whether something is missing that another picture of that depth shows.
  [[nodiscard]] bool gains_from(const NodeField& depth_px) const;

  /// Cells that another picture has to show to go on from here: those that miss something, and
  /// those within reach of them.
  [[nodiscard]] bool is_near_gap(CellPlace cell) const;

  /// How another picture goes on from here.
  [[nodiscard]] NeighbourFit fit(const ShownPart& neighbour) const;

  /// Lays it beneath what is there, blended along the seam.
  void lay_beneath(const ShownPart& neighbour, const NeighbourFit& fit);

  /// What is missing still becomes a blurred continuation of the picture. Returns the pixels that
  /// this makes up most of.
  std::int64_t blur_the_rest();

  /// The picture, when all is done.
  [[nodiscard]] Nv12Buffer take();

 private:
  /// How much of another picture each pixel of a cell takes on.
  using CellShares = std::array<std::array<float, CellGrid::kCellPx>, CellGrid::kCellPx>;

  [[nodiscard]] PicturePlanes planes() const;
  void mark_edge();
  [[nodiscard]] CellShares take_on(CellPlace cell, const NodeField& depth_px,
                                   const NodeField& trust);
  void blend(CellPlace cell, const CellShares& shares, const PicturePlanes& from,
             const NeighbourFit& fit);
  [[nodiscard]] std::uint8_t least_alpha(const PixelBox& box) const;
  [[nodiscard]] std::array<NodeField, 3> continuation() const;
  std::int64_t blur(CellPlace cell, const std::array<NodeField, 3>& continuation);

  [[nodiscard]] std::uint8_t* alpha_at(int x, int y) {
    return alpha_.data() + std::ptrdiff_t{y} * size_.width + x;
  }
  [[nodiscard]] const std::uint8_t* alpha_at(int x, int y) const {
    return alpha_.data() + std::ptrdiff_t{y} * size_.width + x;
  }

  CellGrid grid_;
  ImageSize size_;
  std::optional<Nv12Buffer> picture_;
  float black_ = 16;
  float reach_px_ = 0;
  float band_px_ = 0;  ///< along the seam that pictures are blended in
  float ramp_px_ = 0;  ///< in which an edge fades
  NodeField depth_px_;
  std::vector<CellPlace> open_;      ///< that missed something when it began, or are within reach
  std::vector<std::uint8_t> alpha_;  ///< a pixel: how much of it is there, of 255
};

}  // namespace gimbal
