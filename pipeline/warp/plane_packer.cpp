#include "pipeline/warp/plane_packer.hpp"

#include <utility>

#include "pipeline/warp/plane_format.hpp"
#include "pipeline/warp/shaders.hpp"

namespace gimbal {
namespace {

const char* defines_of(Plane plane, int bytes_per_texel) {
  if (bytes_per_texel == 1) return "#define PIXELS_PER_TEXEL 0.5\n#define HALVES\n";
  return plane == Plane::luma ? "#define PIXELS_PER_TEXEL 4.0\n"
                              : "#define PIXELS_PER_TEXEL 2.0\n#define PAIRS\n";
}

}  // namespace

PlanePacker::PlanePacker(GlProgram program)
    : program_(std::move(program)), corners_(make_corners()) {}

Result<PlanePacker> PlanePacker::create(Plane plane, int bytes_per_texel) {
  return make_program(shaders::kPackVertex, shaders::kPackFragment,
                      defines_of(plane, bytes_per_texel))
      .map([](GlProgram program) { return PlanePacker(std::move(program)); });
}

void PlanePacker::resize(ImageSize packed_size) {
  if (packed_size == packed_size_) return;
  packed_ = make_texture(packed_size, kRgbaFormat, GL_NEAREST);
  framebuffer_ = make_framebuffer(packed_);
  packed_size_ = packed_size;
}

void PlanePacker::pack(GLuint drawn, ImageSize size, GLuint target, ImageSize packed_size) {
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  glViewport(0, 0, packed_size.width, packed_size.height);
  glUseProgram(program_.name());
  set_uniform(program_, "source_size", size);
  set_uniform(program_, "packed_size", packed_size);
  glBindTexture(GL_TEXTURE_2D, drawn);
  draw_corners(program_, corners_);
}

void PlanePacker::read(const GlTexture& drawn, ImageSize size, MutablePlane output) {
  // As wide as the output's rows with their padding: then one call reads all of them.
  resize({static_cast<int>(output.stride_bytes) / kRgbaFormat.bytes_per_pixel, size.height});
  pack(drawn.name(), size, framebuffer_.name(), packed_size_);
  glReadPixels(0, 0, packed_size_.width, packed_size_.height, GL_RGBA, GL_UNSIGNED_BYTE,
               output.data);
}

}  // namespace gimbal
