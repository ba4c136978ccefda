#include "pipeline/warp/gl_objects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace gimbal {
namespace {

// Coordinates across a large frame need more than mediump where the GPU has more.
constexpr std::string_view kPrecision =
    "#ifdef GL_FRAGMENT_PRECISION_HIGH\n"
    "precision highp float;\n"
    "#else\n"
    "precision mediump float;\n"
    "#endif\n";

std::string first_line(std::string_view log) {
  return std::string(log.substr(0, std::min(log.find('\n'), log.find('\0'))));
}

Result<GlShader> compile(GLenum stage, std::string_view name, const std::string& source) {
  GlShader shader(glCreateShader(stage));
  const char* text = source.c_str();
  glShaderSource(shader.name(), 1, &text, nullptr);
  glCompileShader(shader.name());
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  std::array<char, 512> log{};
  glGetShaderInfoLog(shader.name(), static_cast<GLsizei>(log.size()), nullptr, log.data());
  return failed(
      fmt::format("gles: the driver refuses the {} shader: {}", name, first_line(log.data())));
}

}  // namespace

GlTexture make_texture_name(GLint filter) {
  GLuint name = 0;
  glGenTextures(1, &name);
  glBindTexture(GL_TEXTURE_2D, name);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return GlTexture(name);
}

GlTexture make_texture(ImageSize size, const TextureFormat& format, GLint filter) {
  GlTexture texture = make_texture_name(filter);
  glTexImage2D(GL_TEXTURE_2D, 0, format.internal_format, size.width, size.height, 0, format.format,
               GL_UNSIGNED_BYTE, nullptr);
  return texture;
}

GlBuffer make_buffer() {
  GLuint name = 0;
  glGenBuffers(1, &name);
  return GlBuffer(name);
}

GlBuffer make_corners() {
  constexpr std::array<GLfloat, 8> corners = {0, 0, 1, 0, 0, 1, 1, 1};
  GlBuffer buffer = make_buffer();
  glBindBuffer(GL_ARRAY_BUFFER, buffer.name());
  glBufferData(GL_ARRAY_BUFFER, sizeof(corners), corners.data(), GL_STATIC_DRAW);
  return buffer;
}

void draw_corners(const GlProgram& program, const GlBuffer& corners) {
  glClear(GL_COLOR_BUFFER_BIT);  // or a GPU of tiles would load what is there first
  glBindBuffer(GL_ARRAY_BUFFER, corners.name());
  set_attribute(program, "corner", 0, 0);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

void set_attribute(const GlProgram& program, const char* name, GLsizei stride_bytes,
                   std::size_t offset_bytes) {
  const auto location = static_cast<GLuint>(glGetAttribLocation(program.name(), name));
  glEnableVertexAttribArray(location);
  // NOLINTNEXTLINE(performance-no-int-to-ptr): offsets into a bound buffer go by as pointers
  const auto* offset = reinterpret_cast<const void*>(offset_bytes);
  glVertexAttribPointer(location, 2, GL_FLOAT, GL_FALSE, stride_bytes, offset);
}

void set_uniform(const GlProgram& program, const char* name, ImageSize size) {
  glUniform2f(glGetUniformLocation(program.name(), name), static_cast<float>(size.width),
              static_cast<float>(size.height));
}

GlFramebuffer make_framebuffer(const GlTexture& target) {
  GLuint name = 0;
  glGenFramebuffers(1, &name);
  glBindFramebuffer(GL_FRAMEBUFFER, name);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target.name(), 0);
  return GlFramebuffer(name);
}

bool is_complete(const GlFramebuffer& framebuffer) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
  return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

Result<GlProgram> make_program(std::string_view vertex, std::string_view fragment,
                               const std::string& defines) {
  const auto vertex_shader =
      compile(GL_VERTEX_SHADER, "vertex", fmt::format("#version 100\n{}{}", defines, vertex));
  if (!vertex_shader) return tl::unexpected(vertex_shader.error());
  const auto fragment_shader =
      compile(GL_FRAGMENT_SHADER, "fragment",
              fmt::format("#version 100\n{}{}{}", defines, kPrecision, fragment));
  if (!fragment_shader) return tl::unexpected(fragment_shader.error());
  GlProgram program(glCreateProgram());
  glAttachShader(program.name(), vertex_shader->name());
  glAttachShader(program.name(), fragment_shader->name());
  glLinkProgram(program.name());
  GLint linked = GL_FALSE;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  std::array<char, 512> log{};
  glGetProgramInfoLog(program.name(), static_cast<GLsizei>(log.size()), nullptr, log.data());
  return failed(
      fmt::format("gles: the driver cannot link the shaders: {}", first_line(log.data())));
}

}  // namespace gimbal
