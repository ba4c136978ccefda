#include "pipeline/warp/plane_packer.hpp"

#include <utility>

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

void PlanePacker::pack(GLuint drawn, ImageSize size, GLuint target, ImageSize packed_size) {
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  glViewport(0, 0, packed_size.width, packed_size.height);
  glUseProgram(program_.name());
  set_uniform(program_, "source_size", size);
  set_uniform(program_, "packed_size", packed_size);
  glBindTexture(GL_TEXTURE_2D, drawn);
  draw_corners(program_, corners_);
}

}  // namespace gimbal
