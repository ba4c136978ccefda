#pragma once

#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/plane_vertices.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

// A picture that tells whether it was drawn as it is: drivers claim more than they can do, so this
// is drawn instead of asking.

void draw_pattern(MutablePlane memory, ImageSize picture, Plane plane);
[[nodiscard]] bool shows_pattern(ConstPlane memory, ImageSize picture, Plane plane);

/// Whether two such planes differ by rounding at most.
[[nodiscard]] bool are_alike(ConstPlane a, ConstPlane b, ImageSize picture, Plane plane);

[[nodiscard]] MutablePlane plane_of(const Nv12Buffer& picture, Plane plane);

/// One cell that leaves every pixel where it is.
[[nodiscard]] WarpMesh identity_mesh(ImageSize size);

}  // namespace gimbal
