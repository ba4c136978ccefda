#include "pipeline/warp/plane_packer.hpp"

#include <array>
#include <utility>

#include "pipeline/warp/shaders.hpp"

namespace gimbal {
namespace {

constexpr int kBytesPerTexel = 4;

const char* defines_of(Plane plane) {
  return plane == Plane::luma ? "#define PIXELS_PER_TEXEL 4.0\n"
                              : "#define PIXELS_PER_TEXEL 2.0\n#define PAIRS\n";
}

GlBuffer make_corners() {
  constexpr std::array<GLfloat, 8> corners = {0, 0, 1, 0, 0, 1, 1, 1};
  GlBuffer buffer = make_buffer();
  glBindBuffer(GL_ARRAY_BUFFER, buffer.name());
  glBufferData(GL_ARRAY_BUFFER, sizeof(corners), corners.data(), GL_STATIC_DRAW);
  return buffer;
}

}  // namespace

PlanePacker::PlanePacker(GlProgram program)
    : program_(std::move(program)), corners_(make_corners()) {}

Result<PlanePacker> PlanePacker::create(Plane plane) {
  return make_program(shaders::kPackVertex, shaders::kPackFragment, defines_of(plane))
      .map([](GlProgram program) { return PlanePacker(std::move(program)); });
}

void PlanePacker::resize(ImageSize packed_size) {
  if (packed_size == packed_size_) return;
  packed_ = make_texture(packed_size, {GL_RGBA, GL_RGBA, kBytesPerTexel}, GL_NEAREST);
  framebuffer_ = make_framebuffer(packed_);
  packed_size_ = packed_size;
}

void PlanePacker::read(const GlTexture& drawn, ImageSize size, MutablePlane output) {
  // As wide as the output's rows with their padding: then one call reads all of them.
  resize({static_cast<int>(output.stride_bytes) / kBytesPerTexel, size.height});
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, packed_size_.width, packed_size_.height);
  glUseProgram(program_.name());
  set_uniform(program_, "source_size", size);
  set_uniform(program_, "packed_size", packed_size_);
  glBindTexture(GL_TEXTURE_2D, drawn.name());
  glBindBuffer(GL_ARRAY_BUFFER, corners_.name());
  set_attribute(program_, "corner", 0, 0);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  glReadPixels(0, 0, packed_size_.width, packed_size_.height, GL_RGBA, GL_UNSIGNED_BYTE,
               output.data);
}

}  // namespace gimbal
