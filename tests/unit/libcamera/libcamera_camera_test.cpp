#include "drivers/libcamera/libcamera_camera.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace gimbal {
namespace {

using ::testing::HasSubstr;

TEST(OpenLibcameraCamera, RefusesSettingsThatMakeNoSense) {
  const auto message = [](const auto& change) {
    LibcameraSettings settings;
    change(settings);
    const auto camera = open_libcamera_camera(settings);
    return camera ? std::string() : camera.error().message;
  };
  EXPECT_EQ(message([](auto&) {}), "");
  EXPECT_THAT(message([](auto& s) { s.fps = std::nan(""); }), HasSubstr("fps is nan"));
  EXPECT_THAT(message([](auto& s) { s.size = ImageSize{640, -1}; }), HasSubstr("size 640x-1"));
  EXPECT_THAT(message([](auto& s) { s.silence_limit = {}; }), HasSubstr("silence"));
}

TEST(OpenLibcameraCamera, ACameraThatIsNotThereIsAnErrorEachTime) {
  LibcameraSettings settings;
  settings.camera = "no such camera";
  const auto camera = open_libcamera_camera(settings);
  ASSERT_TRUE(camera);
  for (int i = 0; i < 2; ++i) {
    const auto started = (*camera)->start();
    ASSERT_FALSE(started);
    EXPECT_THAT(started.error().message, HasSubstr("libcamera "));
  }
  const auto frame = (*camera)->read();
  ASSERT_TRUE(frame);
  EXPECT_FALSE(frame->has_value());
}

TEST(ListLibcameraCameras, EndsAndCanBeRepeated) {
  EXPECT_EQ(list_libcamera_cameras().size(), list_libcamera_cameras().size());
}

}  // namespace
}  // namespace gimbal
