#include "pipeline/warp/plane_converter.hpp"

#include <cstddef>
#include <string>
#include <utility>

#include "pipeline/warp/plane_format.hpp"
#include "pipeline/warp/shaders.hpp"

namespace gimbal {
namespace {

/// Luma first, then chroma: that of UYVY is the other way round.
std::string channels_of(NativeFormat format, const std::string& channels) {
  switch (format) {
    case NativeFormat::uyvy:
      return {channels.rbegin(), channels.rend()};
    case NativeFormat::rgb:
      return "rgb";
    case NativeFormat::bgr:
      return "bgr";
    default:
      return channels;
  }
}

std::string defines_of(NativeFormat format, Plane plane, const std::string& channels) {
  std::string defines = "#define CHANNELS " + channels_of(format, channels) + "\n";
  if (format == NativeFormat::i420) return defines + "#define PLANAR\n#define SPACING 1.0\n";
  const bool is_422 = format == NativeFormat::yuyv || format == NativeFormat::uyvy;
  if (is_422) defines += "#define PACKED_422\n";
  return defines +
         (plane == Plane::luma ? "#define LUMA\n#define SPACING 1.0\n" : "#define SPACING 2.0\n");
}

}  // namespace

PlaneConverter::PlaneConverter(ImageSize size, GlProgram program, GlTexture pixels)
    : size_(size),
      program_(std::move(program)),
      corners_(make_corners()),
      pixels_(std::move(pixels)),
      framebuffer_(make_framebuffer(pixels_)) {}

Result<PlaneConverter> PlaneConverter::create(NativeFormat format, Plane plane, ImageSize picture,
                                              int gles_version, const std::string& channels) {
  auto program = make_program(shaders::kConvertVertex, shaders::kConvertFragment,
                              defines_of(format, plane, channels));
  if (!program) return tl::unexpected(program.error());
  const ImageSize size = plane_size(picture, plane);
  // GLES 2 draws into RGBA only.
  const TextureFormat target = gles_version >= 3 ? plane_format(plane, gles_version) : kRgbaFormat;
  PlaneConverter made(size, std::move(*program), make_texture(size, target, GL_LINEAR));
  if (!is_complete(made.framebuffer_)) return failed("gles: the driver cannot draw into a texture");
  return made;
}

GLuint PlaneConverter::convert(std::span<const GLuint> sources, ImageSize source_size) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, size_.width, size_.height);
  glUseProgram(program_.name());
  set_uniform(program_, "source_size", source_size);
  set_uniform(program_, "target_size", size_);
  glUniform1i(glGetUniformLocation(program_.name(), "other_source"), 1);
  for (std::size_t unit = sources.size(); unit-- > 0;) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));  // ends with 0, where all else draws
    glBindTexture(GL_TEXTURE_2D, sources[unit]);
  }
  draw_corners(program_, corners_);
  return pixels_.name();
}

}  // namespace gimbal
