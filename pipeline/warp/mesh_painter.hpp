#pragma once

#include <string>
#include <vector>

#include "pipeline/sample/result.hpp"
#include "pipeline/warp/gl_objects.hpp"
#include "pipeline/warp/interpolation.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// Draws a mesh from the texture bound to unit 0 into the bound framebuffer.
class MeshPainter {
 public:
  /// `channels`: where the textures have their two values, such as "rg".
  [[nodiscard]] static Result<MeshPainter> create(const std::string& channels,
                                                  Interpolation interpolation);

  /// Vertices in pixels of one plane, whose sizes are given; triangles and border are the mesh's.
  void draw(const WarpMesh& mesh, const std::vector<MeshVertex>& vertices, ImageSize source,
            ImageSize output);

 private:
  /// For one rule of what is past the edge of the frame.
  struct Programs {
    GlProgram plain;
    GlProgram shrinking;  ///< takes several samples a pixel where the mesh wants that
  };

  MeshPainter(Programs clamped, Programs mirrored);
  [[nodiscard]] static Result<Programs> make_programs(const std::string& defines);

  Programs clamped_;
  Programs mirrored_;
  GlBuffer vertices_;
  GlBuffer triangles_;
};

}  // namespace gimbal
