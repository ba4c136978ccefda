#pragma once

#include <GLES3/gl3.h>

#include <array>
#include <cstdint>

#include "pipeline/warp/mesh_painter.hpp"
#include "pipeline/warp/plane_vertices.hpp"

namespace gimbal {

/// Where a plane comes from and where it is drawn: names of a texture and of a framebuffer.
struct PlaneRoute {
  GLuint source = 0;
  GLuint target = 0;
};

/// Clears the target to `background` (one or two bytes count), then draws the mesh.
void draw_plane(MeshPainter& painter, const WarpMesh& mesh, Plane plane, ChromaSiting siting,
                std::array<std::uint8_t, 2> background, PlaneRoute route);

}  // namespace gimbal
