#pragma once

#include "pipeline/sample/result.hpp"
#include "pipeline/warp/gles_plane.hpp"
#include "pipeline/warp/mesh_painter.hpp"

namespace gimbal {

/// The first way of reading back that gives a small picture back as it was: direct, where the
/// version has it, or else packed. Drivers claim more than they can do, so this draws instead of
/// asking. Fails where neither does.
[[nodiscard]] Result<Readback> choose_readback(MeshPainter& painter, int gles_version);

}  // namespace gimbal
