#include "drivers/v4l2/controls.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "tests/support/fake_v4l2.hpp"

namespace gimbal {
namespace {

using ::testing::HasSubstr;

/// As a webcam of UVC has them.
std::shared_ptr<test::FakeCamera> webcam() {
  auto camera = std::make_shared<test::FakeCamera>();
  camera->controls = {
      {V4L2_CID_BRIGHTNESS, "Brightness", V4L2_CTRL_TYPE_INTEGER, -64, 64, 0},
      {V4L2_CID_CAMERA_CLASS, "Camera Controls", V4L2_CTRL_TYPE_CTRL_CLASS},
      {V4L2_CID_EXPOSURE_AUTO,
       "Auto Exposure",
       V4L2_CTRL_TYPE_MENU,
       0,
       3,
       3,
       0,
       {{1, "Manual Mode"}, {3, "Aperture Priority Mode"}}},
      {V4L2_CID_EXPOSURE_ABSOLUTE,
       "Exposure Time, Absolute",
       V4L2_CTRL_TYPE_INTEGER,
       3,
       2047,
       250,
       0,
       {},
       std::pair(std::uint32_t{V4L2_CID_EXPOSURE_AUTO}, std::int64_t{3})},
      {V4L2_CID_PIXEL_RATE, "Pixel Rate", V4L2_CTRL_TYPE_INTEGER64, 1, 1'000'000'000'000, 1,
       V4L2_CTRL_FLAG_READ_ONLY},
      {V4L2_CID_POWER_LINE_FREQUENCY,
       "Power Line Frequency",
       V4L2_CTRL_TYPE_MENU,
       0,
       2,
       0,
       0,
       {{0, "Disabled"}, {1, "50 Hz"}, {2, "60 Hz"}}},
  };
  return camera;
}

TEST(ControlName, IsSpeltAsV4l2CtlDoes) {
  EXPECT_EQ(control_name("Exposure Time, Absolute"), "exposure_time_absolute");
  EXPECT_EQ(control_name("White Balance, Automatic"), "white_balance_automatic");
  EXPECT_EQ(control_name("  LED1 Mode (new) "), "led1_mode_new");
  EXPECT_EQ(control_name(""), "");
}

TEST(Controls, AreSetByName) {
  const auto camera = webcam();
  const auto device = camera->open();
  ASSERT_TRUE(set_controls(*device, {{"brightness", -20}, {"power_line_frequency", 1}}));
  EXPECT_EQ(camera->value_of("Brightness"), -20);
  EXPECT_EQ(camera->value_of("Power Line Frequency"), 1);
}

TEST(Controls, OneThatAnotherSetsFreeComesAfterIt) {
  const auto camera = webcam();
  const auto device = camera->open();
  // By the alphabet the inactive one would be second as well; so under another name.
  camera->controls[3].name = "Absolute Exposure";
  ASSERT_TRUE(set_controls(*device, {{"absolute_exposure", 100}, {"auto_exposure", 1}}));
  EXPECT_EQ(camera->value_of("Absolute Exposure"), 100);
}

TEST(Controls, OneThatStaysInactiveSaysSo) {
  const auto device = webcam()->open();
  const auto set = set_controls(*device, {{"exposure_time_absolute", 100}});
  ASSERT_FALSE(set);
  EXPECT_THAT(set.error().message, HasSubstr("exposure_time_absolute"));
  EXPECT_THAT(set.error().message, HasSubstr("another control"));
}

TEST(Controls, AnUnknownNameListsThoseThatThereAre) {
  const auto device = webcam()->open();
  const auto set = set_controls(*device, {{"britness", 1}});
  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().kind, Error::Kind::bad_input);
  EXPECT_EQ(set.error().message,
            "has no control britness; it has brightness, power_line_frequency, auto_exposure, "
            "exposure_time_absolute, pixel_rate");
}

TEST(Controls, AValueOutsideTheRangeTellsTheRange) {
  const auto camera = webcam();
  const auto device = camera->open();
  for (const std::int64_t value : {std::int64_t{65}, std::int64_t{-65}, std::int64_t{1} << 32}) {
    const auto set = set_controls(*device, {{"brightness", value}});
    ASSERT_FALSE(set);
    EXPECT_THAT(set.error().message, HasSubstr("from -64 to 64"));
  }
  EXPECT_EQ(camera->value_of("Brightness"), 0);
}

TEST(Controls, AMenuTellsItsEntries) {
  const auto device = webcam()->open();
  for (const std::int64_t value : {2, 7}) {  // a gap, and beyond the end
    const auto set = set_controls(*device, {{"auto_exposure", value}});
    ASSERT_FALSE(set);
    EXPECT_THAT(set.error().message, HasSubstr("1 (Manual Mode), 3 (Aperture Priority Mode)"));
  }
}

TEST(Controls, OneThatCanOnlyBeReadIsNotSet) {
  const auto device = webcam()->open();
  const auto set = set_controls(*device, {{"pixel_rate", 5}});
  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().message, "control pixel_rate can only be read");
}

TEST(FixedExposure, IsKnownOnlyWhereNothingChangesIt) {
  const auto camera = webcam();
  const auto device = camera->open();
  EXPECT_FALSE(fixed_exposure(*device));
  ASSERT_TRUE(set_controls(*device, {{"auto_exposure", 1}, {"exposure_time_absolute", 125}}));
  EXPECT_EQ(fixed_exposure(*device), std::chrono::microseconds(12'500));
  EXPECT_FALSE(fixed_exposure(*std::make_shared<test::FakeCamera>()->open()));
}

}  // namespace
}  // namespace gimbal
