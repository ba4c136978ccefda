#include "pipeline/warp/plane_unpacker.hpp"

#include <utility>

#include "pipeline/warp/plane_format.hpp"
#include "pipeline/warp/shaders.hpp"

namespace gimbal {
namespace {

const char* defines_of(Plane plane, int bytes_per_texel) {
  if (bytes_per_texel == 1) return "#define HALVES\n";
  return plane == Plane::chroma ? "#define PAIRS\n" : "";
}

}  // namespace

PlaneUnpacker::PlaneUnpacker(ImageSize size, GlProgram program, GlTexture pixels)
    : size_(size),
      program_(std::move(program)),
      corners_(make_corners()),
      pixels_(std::move(pixels)),
      framebuffer_(make_framebuffer(pixels_)) {}

Result<PlaneUnpacker> PlaneUnpacker::create(Plane plane, ImageSize picture, int gles_version,
                                            int bytes_per_texel) {
  auto program = make_program(shaders::kUnpackVertex, shaders::kUnpackFragment,
                              defines_of(plane, bytes_per_texel));
  if (!program) return tl::unexpected(program.error());
  const ImageSize size = plane_size(picture, plane);
  // GLES 2 draws into RGBA only.
  const TextureFormat format = gles_version >= 3 ? plane_format(plane, gles_version) : kRgbaFormat;
  PlaneUnpacker made(size, std::move(*program), make_texture(size, format, GL_LINEAR));
  if (!is_complete(made.framebuffer_)) return failed("gles: the driver cannot draw into a texture");
  return made;
}

GLuint PlaneUnpacker::unpack(GLuint packed, ImageSize packed_size) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, size_.width, size_.height);
  glUseProgram(program_.name());
  set_uniform(program_, "source_size", packed_size);
  set_uniform(program_, "target_size", size_);
  glBindTexture(GL_TEXTURE_2D, packed);
  draw_corners(program_, corners_);
  return pixels_.name();
}

}  // namespace gimbal
