#include "pipeline/warp/draw_plane.hpp"

namespace gimbal {

void draw_plane(MeshPainter& painter, const WarpMesh& mesh, Plane plane, ChromaSiting siting,
                std::array<std::uint8_t, 2> background, PlaneRoute route) {
  const ImageSize output = plane_size(mesh.output_size, plane);
  glBindFramebuffer(GL_FRAMEBUFFER, route.target);
  glViewport(0, 0, output.width, output.height);
  glClearColor(static_cast<float>(background[0]) / 255, static_cast<float>(background[1]) / 255, 0,
               1);
  glClear(GL_COLOR_BUFFER_BIT);
  glBindTexture(GL_TEXTURE_2D, route.source);
  painter.draw(mesh, plane_vertices(mesh, plane, siting), plane_size(mesh.source_size, plane),
               output);
}

}  // namespace gimbal
