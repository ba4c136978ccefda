#pragma once

#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// How many samples of the source an output pixel is the mean of, spread evenly over the part of it
/// that the pixel stands for. More than one where the map shrinks the picture: pixels between two
/// samples would be missed, and what is fine would come out as something coarse.
struct SampleGrid {
  int columns = 1;
  int rows = 1;

  [[nodiscard]] bool is_single() const { return columns == 1 && rows == 1; }
};

/// One sample for each pixel of the source that a step passes, up to eight; a step of up to a
/// quarter more than a pixel still counts as one. Steps are in source pixels.
[[nodiscard]] SampleGrid samples_for(double column_step_px, double row_step_px);

/// Whether any part of the mesh wants more than one sample a pixel.
[[nodiscard]] bool shrinks(const WarpMesh& mesh);

}  // namespace gimbal
