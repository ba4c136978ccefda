#pragma once

#include <EGL/egl.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/sample/result.hpp"

struct gbm_device;

namespace gimbal {

/// Whether `name` is one of the words of an extension list; a null list has none.
[[nodiscard]] bool has_extension(const char* extensions, std::string_view name);

/// What `operation` got from eglGetError: "eglInitialize: EGL_NOT_INITIALIZED".
[[nodiscard]] std::string egl_error_text(std::string_view operation);

/// An initialised connection to a renderer, without a window.
class EglDisplay {
 public:
  EglDisplay(const EglDisplay&) = delete;
  EglDisplay& operator=(const EglDisplay&) = delete;
  ~EglDisplay();

  /// On the GPU's render node, such as /dev/dri/renderD128.
  [[nodiscard]] static Result<std::unique_ptr<EglDisplay>> on_render_node(const std::string& path);

  /// Mesa's platform without windows: the first GPU it has, or else its software renderer.
  [[nodiscard]] static Result<std::unique_ptr<EglDisplay>> surfaceless();

  /// What the vendor's EGL opens by itself.
  [[nodiscard]] static Result<std::unique_ptr<EglDisplay>> by_default();

  [[nodiscard]] EGLDisplay handle() const { return handle_; }
  [[nodiscard]] bool has_extension(std::string_view name) const;

 private:
  struct CloseFile {
    void operator()(const int* file) const;
  };
  struct DestroyDevice {
    void operator()(gbm_device* device) const;
  };
  using File = std::unique_ptr<int, CloseFile>;
  using GbmDevice = std::unique_ptr<gbm_device, DestroyDevice>;

  EglDisplay(EGLDisplay handle, File file, GbmDevice device);
  [[nodiscard]] static Result<std::unique_ptr<EglDisplay>> initialize(EGLDisplay handle, File file,
                                                                      GbmDevice device);

  File file_;  ///< of the render node; none on the other platforms
  GbmDevice device_;
  EGLDisplay handle_;
};

/// Paths of the render nodes that exist, in order.
[[nodiscard]] std::vector<std::string> render_nodes();

}  // namespace gimbal
