// What is said where GL is not to be had. Each test runs in a process of its own, since EGL is
// loaded once and keeps its state.

#include <EGL/egl.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "pipeline/warp/warper.hpp"
#include "tests/unit/warp/warp_scene.hpp"

namespace gimbal {
namespace {

/// Prints the error and leaves with 1; leaves with 0 if there is none.
template <typename T>
[[noreturn]] void leave_with(const Result<T>& result) {
  if (!result) std::fprintf(stderr, "%s\n", result.error().message.c_str());
  std::exit(result ? 0 : 1);
}

class GlesFailure : public testing::Test {
 protected:
  void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

using GlesFailureDeathTest = GlesFailure;

TEST_F(GlesFailureDeathTest, NoVendorLibrary) {
  EXPECT_EXIT(
      {
        setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent.json", 1);
        leave_with(make_gles_warper({64, 32}, {64, 32}));
      },
      testing::ExitedWithCode(1), "gles: no usable EGL .*surfaceless: .*default display: ");
}

TEST_F(GlesFailureDeathTest, NoDriver) {
  EXPECT_EXIT(
      {
        setenv("LIBGL_DRIVERS_PATH", "/nonexistent", 1);
        setenv("GBM_BACKENDS_PATH", "/nonexistent", 1);
        setenv("GALLIUM_DRIVER", "none", 1);  // newer Mesa has no drivers in files of their own
        leave_with(make_gles_warper({64, 32}, {64, 32}));
      },
      testing::ExitedWithCode(1), "gles: no usable EGL .*surfaceless: eglInitialize: ");
}

/// Draws before and after the display goes away beneath the context.
[[noreturn]] void lose_context() {
  const ImageSize size{64, 32};
  const auto warper = make_gles_warper(size, size).value();
  const VideoFrame picture = warp_scene::make_picture(size, {});
  const WarpMesh mesh =
      warp_scene::shaky_mesh(size, size, Border::crop, warp_scene::View::zoomed_in);
  if (!warper->warp(picture, mesh)) std::exit(3);
  const EGLDisplay display = eglGetCurrentDisplay();
  eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglTerminate(display);
  if (warper->warp(picture, mesh)) std::exit(4);
  leave_with(warper->warp(picture, mesh));
}

/// The same with frames in flight.
[[noreturn]] void lose_context_in_flight() {
  const ImageSize size{64, 32};
  const auto warper = make_gles_warper(size, size).value();
  const VideoFrame picture = warp_scene::make_picture(size, {});
  const WarpMesh mesh =
      warp_scene::shaky_mesh(size, size, Border::crop, warp_scene::View::zoomed_in);
  for (int i = 0; i < 2; ++i) {
    if (!warper->begin(picture, mesh)) std::exit(3);
  }
  const EGLDisplay display = eglGetCurrentDisplay();
  eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglTerminate(display);
  if (warper->finish()) std::exit(4);
  if (warper->begin(picture, mesh)) std::exit(5);
  leave_with(warper->finish());
}

/// The nearest a test can come to a context lost in a GPU reset.
TEST_F(GlesFailureDeathTest, LostContext) {
  EXPECT_EXIT(lose_context(), testing::ExitedWithCode(1),
              "gles: the context is lost .eglMakeCurrent: ");
}

TEST_F(GlesFailureDeathTest, LostContextWithFramesInFlight) {
  EXPECT_EXIT(lose_context_in_flight(), testing::ExitedWithCode(1),
              "gles: the context is lost .eglMakeCurrent: ");
}

}  // namespace
}  // namespace gimbal
