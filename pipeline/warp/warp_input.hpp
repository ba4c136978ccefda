#pragma once

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// Fails with a line that says so if the mesh was not made for this frame, or either holds nothing.
[[nodiscard]] Result<void> check_warp_input(const VideoFrame& source, const WarpMesh& mesh);

}  // namespace gimbal
