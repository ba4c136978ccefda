#include "drivers/v4l2/sensor_timing.hpp"

#include <gtest/gtest.h>

#include "tests/support/fake_v4l2.hpp"

namespace gimbal {
namespace {

test::FakeControl read_only(std::uint32_t id, std::int64_t value) {
  return {id, "x", V4L2_CTRL_TYPE_INTEGER64, 0, 1'000'000'000'000, value, V4L2_CTRL_FLAG_READ_ONLY};
}

TEST(SensorTiming, FollowsFromPixelRateAndBlanking) {
  const auto camera = std::make_shared<test::FakeCamera>();
  // imx219 at 1920x1080, 30 fps: lines of 3448 pixels at 182.4 MHz, 1763 lines a frame.
  camera->controls = {read_only(V4L2_CID_VBLANK, 683), read_only(V4L2_CID_HBLANK, 1528),
                      read_only(V4L2_CID_PIXEL_RATE, 182'400'000)};
  const auto timing = read_sensor_timing(*camera->open(), {1920, 1080});
  ASSERT_TRUE(timing);
  EXPECT_NEAR(to_seconds(timing->readout), 1080 * 3448 / 182.4e6, 1e-9);
  EXPECT_NEAR(timing->fps, 182.4e6 / (3448 * 1763.0), 1e-6);
}

TEST(SensorTiming, IsUnknownWithoutTheControls) {
  const auto camera = std::make_shared<test::FakeCamera>();
  EXPECT_FALSE(read_sensor_timing(*camera->open(), {1920, 1080}));
  camera->controls = {read_only(V4L2_CID_PIXEL_RATE, 182'400'000)};
  EXPECT_FALSE(read_sensor_timing(*camera->open(), {1920, 1080}));
  camera->controls = {read_only(V4L2_CID_HBLANK, 100), read_only(V4L2_CID_PIXEL_RATE, 0)};
  EXPECT_FALSE(read_sensor_timing(*camera->open(), {1920, 1080}));
  camera->controls[1].value = 1000;
  EXPECT_EQ(read_sensor_timing(*camera->open(), {1920, 1080})->fps, 0);  // no VBLANK
}

TEST(SensorTiming, SizeIsThatOfTheSensorsPad) {
  const auto camera = std::make_shared<test::FakeCamera>();
  EXPECT_EQ(sensor_size(*camera->open()), (ImageSize{64, 48}));
}

}  // namespace
}  // namespace gimbal
