#pragma once

#include <EGL/egl.h>
#include <GLES3/gl3.h>

#include <memory>
#include <string_view>
#include <vector>

#include "pipeline/sample/result.hpp"
#include "pipeline/warp/egl_display.hpp"
#include "pipeline/warp/warper.hpp"

namespace gimbal {

/// An OpenGL ES context that draws into textures only. It belongs to the thread that made it: EGL
/// lets a context be current on one thread at a time, and this one stays current there.
class EglContext {
 public:
  /// Tries GBM on each render node, then Mesa's surfaceless platform, then EGL's default display;
  /// on each GLES 3, then 2, as `version` allows. The context is current afterwards. The error says
  /// what was wrong with each of them.
  [[nodiscard]] static Result<std::unique_ptr<EglContext>> create(GlesVersion version);

  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;
  ~EglContext();

  /// To be called before GL is used: somebody else's context may be current by now. Fails when the
  /// context is lost, or in use on another thread.
  [[nodiscard]] Result<void> make_current();

  /// Fails when the GPU was reset under the context, or when GL has an error pending; `doing` says
  /// what was being done.
  [[nodiscard]] Result<void> check(std::string_view doing) const;

  [[nodiscard]] const EglDisplay& display() const { return *display_; }

  /// 3 or 2: what was asked for, though Mesa gives all of 3 to those who ask for 2.
  [[nodiscard]] int major_version() const { return major_version_; }

 private:
  EglContext(std::unique_ptr<EglDisplay> display, int major_version);

  [[nodiscard]] static Result<std::unique_ptr<EglContext>> create_on(
      Result<std::unique_ptr<EglDisplay>> display, GlesVersion version);
  [[nodiscard]] Result<EGLConfig> choose_config() const;
  [[nodiscard]] Result<void> create_context(EGLConfig config);
  [[nodiscard]] Result<void> create_surface(EGLConfig config);
  [[nodiscard]] Result<void> open();

  using ResetStatus = GLenum (*)();

  std::unique_ptr<EglDisplay> display_;
  int major_version_;
  EGLSurface surface_ = EGL_NO_SURFACE;
  EGLContext context_ = EGL_NO_CONTEXT;
  ResetStatus reset_status_ = nullptr;  ///< only where the driver can tell
};

}  // namespace gimbal
