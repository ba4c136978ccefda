#pragma once

#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/interpolation.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// The plainest warper there is, as a reference for the others: in floating point, pixel by pixel,
/// in the order of the mesh's triangles. Where a triangle's map steps more than a pixel and a
/// quarter of the source from one output pixel to the next, along rows or columns, a pixel is the
/// mean of samples that lie at most about a pixel apart.
[[nodiscard]] VideoFrame warp_by_scalars(const VideoFrame& source, const WarpMesh& mesh,
                                         Interpolation interpolation);

}  // namespace gimbal
