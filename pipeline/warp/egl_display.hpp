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
  /// Closes the device's render node, too.
  struct CloseDevice {
    void operator()(gbm_device* device) const;
  };
  using GbmDevice = std::unique_ptr<gbm_device, CloseDevice>;

  EglDisplay(EGLDisplay handle, GbmDevice device);
  /// Errors begin with the platform's name.
  [[nodiscard]] static Result<std::unique_ptr<EglDisplay>> initialize(std::string_view platform,
                                                                      EGLDisplay handle,
                                                                      GbmDevice device);

  GbmDevice device_;  ///< none on the other platforms
  EGLDisplay handle_;
};

/// Paths of the render nodes that exist, in order.
[[nodiscard]] std::vector<std::string> render_nodes();

}  // namespace gimbal
