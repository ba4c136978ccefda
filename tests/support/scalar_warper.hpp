#pragma once

#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// The plainest warper there is, as a reference for the others: pixel by pixel, in the order of the
/// mesh's triangles, bilinear with weights of 11 bits.
[[nodiscard]] VideoFrame warp_by_scalars(const VideoFrame& source, const WarpMesh& mesh);

}  // namespace gimbal
