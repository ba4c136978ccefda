#pragma once

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <memory>
#include <utility>

#include "pipeline/sample/result.hpp"
#include "pipeline/warp/egl_display.hpp"

namespace gimbal {

/// A point in what the GPU was given to do (EGL_KHR_fence_sync). What came later does not hold up
/// those who wait for it; where there are no fences, they wait for all.
class GlFence {
 public:
  /// Until all that came before is in memory. Fails when the GPU takes longer than half a minute.
  [[nodiscard]] Result<void> wait() const;

 private:
  friend class GlFences;

  struct Destroy {
    EGLDisplay display;
    PFNEGLDESTROYSYNCKHRPROC destroy;
    void operator()(EGLSyncKHR fence) const { destroy(display, fence); }
  };
  using Handle = std::unique_ptr<void, Destroy>;

  GlFence(Handle handle, PFNEGLCLIENTWAITSYNCKHRPROC client_wait)
      : handle_(std::move(handle)), client_wait_(client_wait) {}

  Handle handle_;  ///< null where there are none
  PFNEGLCLIENTWAITSYNCKHRPROC client_wait_;
};

/// Where fences come from.
class GlFences {
 public:
  explicit GlFences(const EglDisplay& display);

  /// Behind all that was drawn so far, which the GPU begins with now.
  [[nodiscard]] GlFence insert() const;

 private:
  EGLDisplay display_;
  PFNEGLCREATESYNCKHRPROC create_ = nullptr;
  PFNEGLDESTROYSYNCKHRPROC destroy_ = nullptr;
  PFNEGLCLIENTWAITSYNCKHRPROC client_wait_ = nullptr;
};

}  // namespace gimbal
