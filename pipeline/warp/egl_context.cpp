#include "pipeline/warp/egl_context.hpp"

#include <EGL/eglext.h>
#include <GLES2/gl2ext.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <utility>

namespace gimbal {
namespace {

/// GLES 2's word for "tell me when the GPU was reset"; null where the driver never does.
GLenum (*find_reset_status())() {
  const auto* extensions = reinterpret_cast<const char*>(glGetString(GL_EXTENSIONS));
  const char* name = nullptr;
  if (has_extension(extensions, "GL_EXT_robustness")) name = "glGetGraphicsResetStatusEXT";
  if (has_extension(extensions, "GL_KHR_robustness")) name = "glGetGraphicsResetStatusKHR";
  return name == nullptr ? nullptr : reinterpret_cast<GLenum (*)()>(eglGetProcAddress(name));
}

std::string gl_error_name(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
      return "out of GPU memory";
    default:
      return fmt::format("GL error {:#x}", error);
  }
}

Error context_lost(std::string_view reason) {
  return {
      Error::Kind::failed,
      fmt::format("gles: the context is lost ({}); make a new warper or use the cpu one", reason)};
}

}  // namespace

EglContext::EglContext(std::unique_ptr<EglDisplay> display, int major_version)
    : display_(std::move(display)), major_version_(major_version) {}

EglContext::~EglContext() {
  if (context_ != EGL_NO_CONTEXT && eglGetCurrentContext() == context_) {
    eglMakeCurrent(display_->handle(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }
  if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_->handle(), surface_);
  if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_->handle(), context_);
}

Result<std::unique_ptr<EglContext>> EglContext::create(GlesVersion version) {
  std::vector<std::string> refusals;
  const auto attempt = [&](Result<std::unique_ptr<EglDisplay>> display) {
    auto context = create_on(std::move(display), version);
    if (!context) refusals.push_back(context.error().message);
    return context;
  };
  for (const std::string& node : render_nodes()) {
    if (auto context = attempt(EglDisplay::on_render_node(node))) return context;
  }
  if (auto context = attempt(EglDisplay::surfaceless())) return context;
  if (auto context = attempt(EglDisplay::by_default())) return context;
  return failed(
      fmt::format("gles: no usable EGL ({}); install a driver such as Mesa's libegl-mesa0 and "
                  "libgl1-mesa-dri, or use the cpu warper",
                  fmt::join(refusals, "; ")));
}

Result<std::unique_ptr<EglContext>> EglContext::create_on(
    Result<std::unique_ptr<EglDisplay>> display, GlesVersion version) {
  if (!display) return tl::unexpected(display.error());
  std::unique_ptr<EglContext> context(
      new EglContext(std::move(*display), version == GlesVersion::best ? 3 : 2));
  auto opened = context->open();
  if (!opened && version == GlesVersion::best) {
    context.reset(new EglContext(std::move(context->display_), 2));
    opened = context->open();
  }
  if (!opened) return tl::unexpected(opened.error());
  return context;
}

Result<EGLConfig> EglContext::choose_config() const {
  const bool needs_surface = !display_->has_extension("EGL_KHR_surfaceless_context");
  const EGLint attributes[] = {
      EGL_SURFACE_TYPE, needs_surface ? EGL_PBUFFER_BIT : 0, EGL_RENDERABLE_TYPE,
      major_version_ == 3 ? EGL_OPENGL_ES3_BIT_KHR : EGL_OPENGL_ES2_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint found = 0;
  if (eglChooseConfig(display_->handle(), attributes, &config, 1, &found) != EGL_TRUE) {
    return failed(egl_error_text("eglChooseConfig"));
  }
  if (found == 0) return failed(fmt::format("no OpenGL ES {} here", major_version_));
  return config;
}

Result<void> EglContext::create_context(EGLConfig config) {
  std::vector<EGLint> attributes = {EGL_CONTEXT_CLIENT_VERSION, major_version_};
  if (display_->has_extension("EGL_EXT_create_context_robustness")) {
    attributes.insert(attributes.end(), {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT,
                                         EGL_LOSE_CONTEXT_ON_RESET_EXT});
  }
  attributes.push_back(EGL_NONE);
  context_ = eglCreateContext(display_->handle(), config, EGL_NO_CONTEXT, attributes.data());
  if (context_ == EGL_NO_CONTEXT) {  // some drivers list the extension and refuse its attribute
    const EGLint plain[] = {EGL_CONTEXT_CLIENT_VERSION, major_version_, EGL_NONE};
    context_ = eglCreateContext(display_->handle(), config, EGL_NO_CONTEXT, plain);
  }
  if (context_ == EGL_NO_CONTEXT) return failed(egl_error_text("eglCreateContext"));
  return {};
}

Result<void> EglContext::create_surface(EGLConfig config) {
  if (display_->has_extension("EGL_KHR_surfaceless_context")) return {};
  const EGLint attributes[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
  surface_ = eglCreatePbufferSurface(display_->handle(), config, attributes);
  if (surface_ == EGL_NO_SURFACE) return failed(egl_error_text("eglCreatePbufferSurface"));
  return {};
}

Result<void> EglContext::open() {
  if (eglBindAPI(EGL_OPENGL_ES_API) != EGL_TRUE) return failed(egl_error_text("eglBindAPI"));
  const auto config = choose_config();
  if (!config) return tl::unexpected(config.error());
  if (auto created = create_context(*config); !created) return created;
  if (auto created = create_surface(*config); !created) return created;
  if (eglMakeCurrent(display_->handle(), surface_, surface_, context_) != EGL_TRUE) {
    return failed(egl_error_text("eglMakeCurrent"));
  }
  reset_status_ = find_reset_status();
  return {};
}

Result<void> EglContext::make_current() {
  eglBindAPI(EGL_OPENGL_ES_API);  // which API is meant is also the thread's state
  if (eglGetCurrentContext() == context_) return {};
  if (eglMakeCurrent(display_->handle(), surface_, surface_, context_) == EGL_TRUE) return {};
  return tl::unexpected(context_lost(egl_error_text("eglMakeCurrent")));
}

Result<void> EglContext::check(std::string_view doing) const {
  if (reset_status_ != nullptr && reset_status_() != GL_NO_ERROR) {
    return tl::unexpected(context_lost("the GPU was reset"));
  }
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return {};
  if (error == GL_CONTEXT_LOST_KHR) return tl::unexpected(context_lost("GL_CONTEXT_LOST"));
  return failed(fmt::format("gles: {} failed: {}", doing, gl_error_name(error)));
}

}  // namespace gimbal
