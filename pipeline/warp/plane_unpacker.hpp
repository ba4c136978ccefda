#pragma once

#include "pipeline/sample/result.hpp"
#include "pipeline/warp/gl_objects.hpp"
#include "pipeline/warp/plane_vertices.hpp"

namespace gimbal {

/// The other way round than PlanePacker: brings a plane from a texture whose texels do not hold a
/// pixel each to one that can be drawn from.
class PlaneUnpacker {
 public:
  /// `picture`: size of the whole pictures; `bytes_per_texel`: 4, or 1 for chroma. Fails where the
  /// driver cannot draw into such textures.
  [[nodiscard]] static Result<PlaneUnpacker> create(Plane plane, ImageSize picture,
                                                    int gles_version, int bytes_per_texel);

  /// From a texture of `packed_size` texels to the one with the plane's pixels, values in
  /// kImportedChannels.
  [[nodiscard]] GLuint unpack(GLuint packed, ImageSize packed_size);

 private:
  PlaneUnpacker(ImageSize size, GlProgram program, GlTexture pixels);

  ImageSize size_;
  GlProgram program_;
  GlBuffer corners_;
  GlTexture pixels_;
  GlFramebuffer framebuffer_;
};

}  // namespace gimbal
