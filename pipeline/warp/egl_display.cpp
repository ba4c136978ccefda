#include "pipeline/warp/egl_display.hpp"

#include <EGL/eglext.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <gbm.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace gimbal {
namespace {

std::string_view egl_error_name(EGLint error) {
  switch (error) {
    case EGL_SUCCESS:
      return "no reason given";
    case EGL_NOT_INITIALIZED:
      return "EGL_NOT_INITIALIZED";
    case EGL_BAD_ACCESS:
      return "EGL_BAD_ACCESS";
    case EGL_BAD_ALLOC:
      return "EGL_BAD_ALLOC";
    case EGL_BAD_ATTRIBUTE:
      return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_CONFIG:
      return "EGL_BAD_CONFIG";
    case EGL_BAD_CONTEXT:
      return "EGL_BAD_CONTEXT";
    case EGL_BAD_DISPLAY:
      return "EGL_BAD_DISPLAY";
    case EGL_BAD_MATCH:
      return "EGL_BAD_MATCH";
    case EGL_BAD_PARAMETER:
      return "EGL_BAD_PARAMETER";
    case EGL_CONTEXT_LOST:
      return "EGL_CONTEXT_LOST";
    default:
      return "";
  }
}

/// The display of a platform that EGL's client library offers; EGL_NO_DISPLAY if it does not.
EGLDisplay platform_display(EGLenum platform, std::string_view extension, void* native) {
  const char* offered = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (!has_extension(offered, "EGL_EXT_platform_base") || !has_extension(offered, extension)) {
    return EGL_NO_DISPLAY;
  }
  const auto get_platform_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
      eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (get_platform_display == nullptr) return EGL_NO_DISPLAY;
  return get_platform_display(platform, native, nullptr);
}

}  // namespace

bool has_extension(const char* extensions, std::string_view name) {
  if (extensions == nullptr) return false;
  std::string_view rest(extensions);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    if (rest.substr(0, end) == name) return true;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return false;
}

std::string egl_error_text(std::string_view operation) {
  const EGLint error = eglGetError();
  const std::string_view name = egl_error_name(error);
  return name.empty() ? fmt::format("{}: EGL error {:#x}", operation, error)
                      : fmt::format("{}: {}", operation, name);
}

void EglDisplay::CloseDevice::operator()(gbm_device* device) const {
  const int file = gbm_device_get_fd(device);
  gbm_device_destroy(device);
  close(file);
}

EglDisplay::EglDisplay(EGLDisplay handle, GbmDevice device)
    : device_(std::move(device)), handle_(handle) {}

EglDisplay::~EglDisplay() {
  // The other platforms have one display in the whole process: to terminate it would take it from
  // everyone else in here who draws, such as GStreamer or a second warper.
  if (device_) eglTerminate(handle_);
}

Result<std::unique_ptr<EglDisplay>> EglDisplay::on_render_node(const std::string& path) {
  const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) return failed(fmt::format("{}: {}", path, std::strerror(errno)));
  GbmDevice device(gbm_create_device(file));
  if (!device) {
    close(file);
    return failed(fmt::format("{}: GBM does not know this device", path));
  }
  EGLDisplay handle = platform_display(EGL_PLATFORM_GBM_KHR, "EGL_KHR_platform_gbm", device.get());
  if (handle == EGL_NO_DISPLAY) {
    handle = platform_display(EGL_PLATFORM_GBM_KHR, "EGL_MESA_platform_gbm", device.get());
  }
  return initialize(path, handle, std::move(device));
}

Result<std::unique_ptr<EglDisplay>> EglDisplay::surfaceless() {
  const EGLDisplay handle =
      platform_display(EGL_PLATFORM_SURFACELESS_MESA, "EGL_MESA_platform_surfaceless",
                       reinterpret_cast<void*>(EGL_DEFAULT_DISPLAY));
  return initialize("surfaceless", handle, nullptr);
}

Result<std::unique_ptr<EglDisplay>> EglDisplay::by_default() {
  return initialize("default display", eglGetDisplay(EGL_DEFAULT_DISPLAY), nullptr);
}

Result<std::unique_ptr<EglDisplay>> EglDisplay::initialize(std::string_view platform,
                                                           EGLDisplay handle, GbmDevice device) {
  if (handle == EGL_NO_DISPLAY) return failed(fmt::format("{}: not offered by this EGL", platform));
  if (eglInitialize(handle, nullptr, nullptr) != EGL_TRUE) {
    return failed(fmt::format("{}: {}", platform, egl_error_text("eglInitialize")));
  }
  return std::unique_ptr<EglDisplay>(new EglDisplay(handle, std::move(device)));
}

bool EglDisplay::has_extension(std::string_view name) const {
  return gimbal::has_extension(eglQueryString(handle_, EGL_EXTENSIONS), name);
}

std::vector<std::string> render_nodes() {
  std::vector<std::string> nodes;
  std::error_code unreadable;  // then there are none for us
  for (const auto& entry : std::filesystem::directory_iterator("/dev/dri", unreadable)) {
    if (entry.path().filename().string().starts_with("renderD")) nodes.push_back(entry.path());
  }
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

}  // namespace gimbal
