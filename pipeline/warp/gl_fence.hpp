#pragma once

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "pipeline/sample/result.hpp"
#include "pipeline/warp/egl_display.hpp"

namespace gimbal {

/// Waits for the GPU where nothing is read back: by a fence (EGL_KHR_fence_sync), which other work
/// of the GPU does not hold up, or else for all that it has to do.
class GlFence {
 public:
  explicit GlFence(const EglDisplay& display);

  /// Until all that was drawn so far is in memory. Fails when the GPU takes longer than half a
  /// minute.
  [[nodiscard]] Result<void> wait() const;

 private:
  EGLDisplay display_;
  PFNEGLCREATESYNCKHRPROC create_ = nullptr;
  PFNEGLDESTROYSYNCKHRPROC destroy_ = nullptr;
  PFNEGLCLIENTWAITSYNCKHRPROC client_wait_ = nullptr;
};

}  // namespace gimbal
