#pragma once

#include <span>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/gl_objects.hpp"
#include "pipeline/warp/plane_vertices.hpp"

namespace gimbal {

/// Draws one plane of NV12 out of textures that hold a native picture: the GPU's part of what
/// nv12_conversion does on the CPU, with the same result.
class PlaneConverter {
 public:
  /// `picture`: size of the whole pictures; `channels`: where the textures of 4:2:2 have their two
  /// bytes a pixel, such as "rg". I420's luma needs no converter. Fails where the driver cannot
  /// draw into such textures.
  [[nodiscard]] static Result<PlaneConverter> create(NativeFormat format, Plane plane,
                                                     ImageSize picture, int gles_version,
                                                     const std::string& channels);

  /// `sources`: of I420 U and V, else one texture; all have `source_size` texels and are sampled at
  /// the nearest. Gives the texture with the plane's pixels, values in texture_channels.
  [[nodiscard]] GLuint convert(std::span<const GLuint> sources, ImageSize source_size);

 private:
  PlaneConverter(ImageSize size, GlProgram program, GlTexture pixels);

  ImageSize size_;
  GlProgram program_;
  GlBuffer corners_;
  GlTexture pixels_;
  GlFramebuffer framebuffer_;
};

}  // namespace gimbal
