#include "pipeline/warp/gl_fence.hpp"

#include <GLES3/gl3.h>

namespace gimbal {
namespace {

/// No GPU draws a frame that slowly; an emulated processor that compiles its shaders may.
constexpr EGLTimeKHR kPatience_ns = 30'000'000'000;

}  // namespace

Result<void> GlFence::wait() const {
  if (!handle_) {
    glFinish();
    return {};
  }
  const EGLint status = client_wait_(handle_.get_deleter().display, handle_.get(),
                                     EGL_SYNC_FLUSH_COMMANDS_BIT_KHR, kPatience_ns);
  if (status == EGL_CONDITION_SATISFIED_KHR) return {};
  if (status == EGL_TIMEOUT_EXPIRED_KHR) {
    return failed("gles: the GPU did not draw a frame within half a minute");
  }
  return failed("gles: " + egl_error_text("eglClientWaitSyncKHR"));
}

GlFences::GlFences(const EglDisplay& display) : display_(display.handle()) {
  if (!display.has_extension("EGL_KHR_fence_sync")) return;
  create_ = reinterpret_cast<PFNEGLCREATESYNCKHRPROC>(eglGetProcAddress("eglCreateSyncKHR"));
  destroy_ = reinterpret_cast<PFNEGLDESTROYSYNCKHRPROC>(eglGetProcAddress("eglDestroySyncKHR"));
  client_wait_ =
      reinterpret_cast<PFNEGLCLIENTWAITSYNCKHRPROC>(eglGetProcAddress("eglClientWaitSyncKHR"));
}

GlFence GlFences::insert() const {
  const bool has_fences = create_ != nullptr && destroy_ != nullptr && client_wait_ != nullptr;
  EGLSyncKHR fence = has_fences ? create_(display_, EGL_SYNC_FENCE_KHR, nullptr) : EGL_NO_SYNC_KHR;
  glFlush();
  return {{fence, {display_, destroy_}}, client_wait_};
}

}  // namespace gimbal
