#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/warp/sample_grid.hpp"
#include "pipeline/warp/span_painter.hpp"

namespace gimbal {

/// Draws areas whose pixels are means of several samples. Keeps its memory from one call to the
/// next.
class AreaPainter {
 public:
  /// As paint_area, around which the samples of `grid` are laid.
  void paint(Plane plane, Interpolation interpolation, const SourcePlane& source,
             const AffineMap& map, SampleGrid grid, std::span<const Trapezoid, 2> area,
             const OutputPlane& output);

 private:
  void add_samples();

  std::vector<std::uint8_t> samples_;  ///< of the rectangle around an area, one for each pixel
  std::vector<std::uint16_t> sums_;    ///< of all samples of each pixel
};

}  // namespace gimbal
