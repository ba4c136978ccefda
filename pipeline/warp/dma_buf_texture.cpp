#include "pipeline/warp/dma_buf_texture.hpp"

#include <fmt/format.h>
#include <gbm.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace gimbal {
namespace {

/// Longer than memory that is in use rests, as a rule; else it is imported once more.
constexpr std::int64_t kKeptFrames = 64;

EGLint format_of(int bytes_per_texel) {
  switch (bytes_per_texel) {
    case 1:
      return GBM_FORMAT_R8;
    case 2:
      return GBM_FORMAT_GR88;
    default:
      return GBM_FORMAT_ABGR8888;
  }
}

template <typename Function>
Function find_function(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

bool lie_alike(const DmaBufTexels& a, const DmaBufTexels& b) {
  return a.place.offset_bytes == b.place.offset_bytes && a.stride_bytes == b.stride_bytes &&
         a.size == b.size && a.bytes_per_texel == b.bytes_per_texel;
}

}  // namespace

std::string_view dma_buf_text(PlaneView view) {
  switch (view) {
    case PlaneView::pixels:
      return "dma-buf R8+GR88";
    case PlaneView::bytes:
      return "dma-buf R8";
    case PlaneView::packed:
      break;
  }
  return "dma-buf RGBA";
}

int bytes_per_texel(PlaneView view, Plane plane) {
  if (view == PlaneView::packed) return 4;
  return view == PlaneView::pixels && plane == Plane::chroma ? 2 : 1;
}

ImageSize texels_of(PlaneView view, Plane plane, ImageSize picture) {
  const ImageSize size = plane_size(picture, plane);
  const int row_bytes = plane == Plane::chroma ? 2 * size.width : size.width;
  const int bytes = bytes_per_texel(view, plane);
  return {(row_bytes + bytes - 1) / bytes, size.height};
}

DmaBufTextures::DmaBufTextures(EGLDisplay display, Functions functions)
    : display_(display), functions_(functions) {}

Result<DmaBufTextures> DmaBufTextures::create(const EglDisplay& display) {
  const Functions functions = {
      find_function<PFNEGLCREATEIMAGEKHRPROC>("eglCreateImageKHR"),
      find_function<PFNEGLDESTROYIMAGEKHRPROC>("eglDestroyImageKHR"),
      find_function<void (*)(GLenum, GlEglImage)>("glEGLImageTargetTexture2DOES")};
  const auto* extensions = reinterpret_cast<const char*>(glGetString(GL_EXTENSIONS));
  // Whether it works, drawing tells; without the extension the calls would be undefined.
  if (!display.has_extension("EGL_EXT_image_dma_buf_import") ||
      !has_extension(extensions, "GL_OES_EGL_image") || functions.create_image == nullptr ||
      functions.destroy_image == nullptr || functions.image_to_texture == nullptr) {
    return failed("the driver imports no dma-bufs");
  }
  return DmaBufTextures(display.handle(), functions);
}

Result<DmaBufTextures::Import*> DmaBufTextures::find_or_import(const DmaBufTexels& texels) {
  struct stat status {};
  if (::fstat(texels.place.fd, &status) != 0) {
    return failed(fmt::format("a dma-buf cannot be looked at: {}", std::strerror(errno)));
  }
  for (Import& known : imports_) {
    if (known.inode != status.st_ino || !lie_alike(known.texels, texels)) continue;
    known.last_used = frames_;
    return &known;
  }
  auto made = import(texels);
  if (!made) return tl::unexpected(made.error());
  made->inode = status.st_ino;
  imports_.push_back(std::move(*made));
  return &imports_.back();
}

Result<DmaBufTextures::Import> DmaBufTextures::import(const DmaBufTexels& texels) const {
  const EGLint attributes[] = {EGL_WIDTH,
                               texels.size.width,
                               EGL_HEIGHT,
                               texels.size.height,
                               EGL_LINUX_DRM_FOURCC_EXT,
                               format_of(texels.bytes_per_texel),
                               EGL_DMA_BUF_PLANE0_FD_EXT,
                               texels.place.fd,
                               EGL_DMA_BUF_PLANE0_OFFSET_EXT,
                               static_cast<EGLint>(texels.place.offset_bytes),
                               EGL_DMA_BUF_PLANE0_PITCH_EXT,
                               static_cast<EGLint>(texels.stride_bytes),
                               EGL_NONE};
  EGLImageKHR image =
      functions_.create_image(display_, EGL_NO_CONTEXT, EGL_LINUX_DMA_BUF_EXT, nullptr, attributes);
  if (image == EGL_NO_IMAGE_KHR) return failed(egl_error_text("eglCreateImageKHR"));
  return Import{0, texels, {image, {display_, functions_.destroy_image}}, {}, {}, frames_};
}

Result<GLuint> DmaBufTextures::source(const DmaBufTexels& texels, GLint filter) {
  const auto found = find_or_import(texels);
  if (!found) return tl::unexpected(found.error());
  Import& import = **found;
  if (import.texture.name() == 0) import.texture = make_texture_name(filter);
  glBindTexture(GL_TEXTURE_2D, import.texture.name());
  // Each time, since a driver may keep what it has read of the memory until then.
  functions_.image_to_texture(GL_TEXTURE_2D, import.image.get());
  if (glGetError() != GL_NO_ERROR) return failed("the driver makes no texture of a dma-buf");
  return import.texture.name();
}

Result<GLuint> DmaBufTextures::target(const DmaBufTexels& texels) {
  const auto found = find_or_import(texels);
  if (!found) return tl::unexpected(found.error());
  Import& import = **found;
  if (import.framebuffer.name() != 0) return import.framebuffer.name();
  import.texture = make_texture_name(GL_NEAREST);
  functions_.image_to_texture(GL_TEXTURE_2D, import.image.get());
  import.framebuffer = make_framebuffer(import.texture);
  if (glGetError() != GL_NO_ERROR || !is_complete(import.framebuffer)) {
    import.framebuffer = {};
    return failed("the driver does not draw into a dma-buf");
  }
  return import.framebuffer.name();
}

void DmaBufTextures::forget_unused() {
  ++frames_;
  std::erase_if(imports_,
                [this](const Import& import) { return frames_ - import.last_used > kKeptFrames; });
}

}  // namespace gimbal
