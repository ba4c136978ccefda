#pragma once

#include <vector>

#include "pipeline/sample/result.hpp"
#include "pipeline/warp/gl_objects.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// Draws a mesh from the texture bound to unit 0 into the bound framebuffer.
class MeshPainter {
 public:
  /// `channels`: where the textures have their two values, such as "rg".
  [[nodiscard]] static Result<MeshPainter> create(const std::string& channels);

  /// Vertices in pixels of one plane, whose sizes are given; triangles and border are the mesh's.
  void draw(const WarpMesh& mesh, const std::vector<MeshVertex>& vertices, ImageSize source,
            ImageSize output);

 private:
  MeshPainter(GlProgram clamped, GlProgram mirrored);

  GlProgram clamped_;
  GlProgram mirrored_;
  GlBuffer vertices_;
  GlBuffer triangles_;
};

}  // namespace gimbal
