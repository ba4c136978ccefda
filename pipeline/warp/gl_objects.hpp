#pragma once

#include <GLES3/gl3.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Owns the name of a GL object. Its context has to be current when it goes.
template <auto kDelete>
class GlObject {
 public:
  GlObject() = default;
  explicit GlObject(GLuint name) : name_(name) {}
  GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  GlObject(const GlObject&) = delete;
  GlObject& operator=(const GlObject&) = delete;
  ~GlObject() {
    if (name_ != 0) kDelete(name_);
  }

  [[nodiscard]] GLuint name() const { return name_; }

 private:
  GLuint name_ = 0;
};

inline void delete_texture(GLuint name) {
  glDeleteTextures(1, &name);
}
inline void delete_buffer(GLuint name) {
  glDeleteBuffers(1, &name);
}
inline void delete_framebuffer(GLuint name) {
  glDeleteFramebuffers(1, &name);
}
inline void delete_shader(GLuint name) {
  glDeleteShader(name);
}
inline void delete_program(GLuint name) {
  glDeleteProgram(name);
}

using GlTexture = GlObject<delete_texture>;
using GlBuffer = GlObject<delete_buffer>;
using GlFramebuffer = GlObject<delete_framebuffer>;
using GlShader = GlObject<delete_shader>;
using GlProgram = GlObject<delete_program>;

/// How bytes lie in a texture.
struct TextureFormat {
  GLint internal_format;
  GLenum format;
  int bytes_per_pixel;
};

/// Bound, without memory; samples are clamped to its edge.
[[nodiscard]] GlTexture make_texture_name(GLint filter);

/// Without contents; samples are clamped to its edge.
[[nodiscard]] GlTexture make_texture(ImageSize size, const TextureFormat& format, GLint filter);

[[nodiscard]] GlBuffer make_buffer();

/// The corners of a rectangle, 0 or 1.
[[nodiscard]] GlBuffer make_corners();

/// Draws them with the program in use, as its attribute `corner`: all of the target is covered.
void draw_corners(const GlProgram& program, const GlBuffer& corners);

/// Vertex attribute `name` of the program, two floats each, from the buffer bound to
/// GL_ARRAY_BUFFER.
void set_attribute(const GlProgram& program, const char* name, GLsizei stride_bytes,
                   std::size_t offset_bytes);

/// Uniform vec2 `name` of the program in use.
void set_uniform(const GlProgram& program, const char* name, ImageSize size);

/// A framebuffer that draws into the texture. Check `is_complete` before use.
[[nodiscard]] GlFramebuffer make_framebuffer(const GlTexture& target);
[[nodiscard]] bool is_complete(const GlFramebuffer& framebuffer);

/// Sources in GLSL ES 1.00, which both GLES 2 and 3 take. `defines` (and extensions) come before
/// both. The error
/// has the compiler's own first line.
[[nodiscard]] Result<GlProgram> make_program(std::string_view vertex, std::string_view fragment,
                                             const std::string& defines);

}  // namespace gimbal
