#pragma once

#include "pipeline/sample/result.hpp"
#include "pipeline/warp/gl_objects.hpp"
#include "pipeline/warp/plane_vertices.hpp"

namespace gimbal {

/// Brings a plane that was drawn into an RGBA texture, one pixel a texel, to its bytes in a row:
/// GLES 2 promises to read back nothing but RGBA, and some drivers draw into nothing else, so
/// several bytes of a row are put into one texel.
class PlanePacker {
 public:
  /// `bytes_per_texel`: 4, or 1 for chroma.
  [[nodiscard]] static Result<PlanePacker> create(Plane plane, int bytes_per_texel);

  /// Draws it so. `drawn` has `size` texels: luma in r, chroma in r and g; `target` has
  /// `packed_size`.
  void pack(GLuint drawn, ImageSize size, GLuint target, ImageSize packed_size);

 private:
  explicit PlanePacker(GlProgram program);

  GlProgram program_;
  GlBuffer corners_;
};

}  // namespace gimbal
