#pragma once

#include "pipeline/sample/result.hpp"
#include "pipeline/warp/gl_objects.hpp"
#include "pipeline/warp/plane_vertices.hpp"

namespace gimbal {

/// Brings a plane that was drawn into an RGBA texture, one pixel a texel, into memory: GLES 2
/// promises to read back nothing but RGBA, so four bytes of a row are put into one texel first.
class PlanePacker {
 public:
  [[nodiscard]] static Result<PlanePacker> create(Plane plane);

  /// `drawn` has `size` texels: luma in r, chroma in r and g. The output's stride is a multiple
  /// of 4.
  void read(const GlTexture& drawn, ImageSize size, MutablePlane output);

 private:
  explicit PlanePacker(GlProgram program);
  void resize(ImageSize packed_size);

  GlProgram program_;
  GlBuffer corners_;
  ImageSize packed_size_;
  GlTexture packed_;
  GlFramebuffer framebuffer_;
};

}  // namespace gimbal
