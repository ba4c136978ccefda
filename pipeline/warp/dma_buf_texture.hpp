#pragma once

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl3.h>

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <string_view>

#include "pipeline/sample/result.hpp"
#include "pipeline/warp/egl_display.hpp"
#include "pipeline/warp/gl_objects.hpp"
#include "pipeline/warp/plane_vertices.hpp"

// GLES2/gl2ext.h and GLES3 do not go together in one translation unit of every Mesa.
using GlEglImage = void*;

namespace gimbal {

/// As what the GPU sees a plane that lies in a dma-buf.
enum class PlaneView : std::uint8_t {
  pixels,  ///< R8 or GR88, a texel a pixel
  bytes,   ///< R8, a texel a byte
  packed,  ///< ABGR8888, four bytes a texel
};

/// For people: "dma-buf R8+GR88".
[[nodiscard]] std::string_view dma_buf_text(PlaneView view);

[[nodiscard]] int bytes_per_texel(PlaneView view, Plane plane);

/// How many texels the plane of such a picture has in this view.
[[nodiscard]] ImageSize texels_of(PlaneView view, Plane plane, ImageSize picture);

/// Rows of texels in a dma-buf.
struct DmaBufTexels {
  DmaBufPlane place;
  std::ptrdiff_t stride_bytes = 0;
  ImageSize size;           ///< in texels
  int bytes_per_texel = 0;  ///< 1, 2 or 4
};

/// Makes textures of dma-bufs (EGL_EXT_image_dma_buf_import, GL_OES_EGL_image): the GPU reads and
/// draws the memory where it lies. They are kept, since cameras and pools use the same few memories
/// again and again. What was not used for some time is let go, so that its memory is.
class DmaBufTextures {
 public:
  /// Needs a current context. Fails where EGL has no such images.
  [[nodiscard]] static Result<DmaBufTextures> create(const EglDisplay& display);

  DmaBufTextures(DmaBufTextures&&) = default;
  DmaBufTextures& operator=(DmaBufTextures&&) = default;
  DmaBufTextures(const DmaBufTextures&) = delete;
  DmaBufTextures& operator=(const DmaBufTextures&) = delete;
  ~DmaBufTextures() = default;

  /// To be drawn from as the memory is now, with `filter`. Fails where the driver does not take
  /// such memory.
  [[nodiscard]] Result<GLuint> source(const DmaBufTexels& texels, GLint filter);

  /// A framebuffer that draws into it. Fails where the driver does not.
  [[nodiscard]] Result<GLuint> target(const DmaBufTexels& texels);

  /// To be called once a frame.
  void forget_unused();

  void forget_all() { imports_.clear(); }

 private:
  struct Functions {
    PFNEGLCREATEIMAGEKHRPROC create_image;
    PFNEGLDESTROYIMAGEKHRPROC destroy_image;
    void (*image_to_texture)(GLenum target, GlEglImage image);
  };
  struct DestroyImage {
    EGLDisplay display;
    PFNEGLDESTROYIMAGEKHRPROC destroy;
    void operator()(void* image) const { destroy(display, image); }
  };
  struct Import {
    std::uint64_t inode;  ///< the same for all of its descriptors, and its own while it is held
    DmaBufTexels texels;
    std::unique_ptr<void, DestroyImage> image;
    GlTexture texture;
    GlFramebuffer framebuffer;  ///< of a target
    std::int64_t last_used;
  };

  DmaBufTextures(EGLDisplay display, Functions functions);
  [[nodiscard]] Result<Import*> find_or_import(const DmaBufTexels& texels);
  [[nodiscard]] Result<Import> import(const DmaBufTexels& texels) const;

  EGLDisplay display_;
  Functions functions_;
  std::list<Import> imports_;
  std::int64_t frames_ = 0;
};

}  // namespace gimbal
