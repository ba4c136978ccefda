#include "daemon/configuration.hpp"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>

#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

class ConfigurationTest : public ::testing::Test {
 protected:
  Result<Configuration> load(const std::string& text, const std::string& more = "") {
    folder_.write("a.toml", text);
    folder_.write("b.toml", more);
    const std::array<std::filesystem::path, 2> files = {folder_.path() / "a.toml",
                                                        folder_.path() / "b.toml"};
    return load_configuration(files);
  }

  test::TemporaryFolder folder_;
};

TEST_F(ConfigurationTest, NamesCameraAndImu) {
  const auto read = load(
      "outputs = [\"-\"]\n[camera]\ndriver = \"v4l2\"\nhorizontal_fov_deg = 70\n"
      "[v4l2]\ndevice = \"/dev/video2\"\nwidth = 640\nheight = 360\nfps = 25\n"
      "[v4l2.controls]\nexposure_auto = 1\nflip = true\n"
      "[imu]\ndriver = \"i2c_lsm6dso\"\n[i2c]\nbus = \"/dev/i2c-7\"\naddress = 0x6b\n"
      "accel_range_g = 8\ndelivery = \"polling\"\ndata_ready = \"gpiochip0:4\"\n");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->source, SourceKind::devices);
  EXPECT_EQ(read->camera.v4l2.device, "/dev/video2");
  EXPECT_EQ(read->camera.v4l2.size, (ImageSize{640, 360}));
  EXPECT_EQ(read->camera.v4l2.controls.at("exposure_auto"), 1);
  EXPECT_EQ(read->camera.v4l2.controls.at("flip"), 1);
  EXPECT_EQ(read->imu.driver, ImuDriver::i2c_lsm6dso);
  EXPECT_EQ(read->imu.i2c.address.bus, "/dev/i2c-7");
  EXPECT_EQ(read->imu.i2c.address.chip, 0x6b);
  EXPECT_EQ(read->imu.i2c.accel_range, AccelRange::g_8);
  EXPECT_EQ(read->imu.i2c.delivery, SampleDelivery::polling);
  EXPECT_EQ(read->imu.data_ready, "gpiochip0:4");
}

TEST_F(ConfigurationTest, ALaterFileChangesSingleKeys) {
  const auto read = load(
      "outputs = [\"-\"]\n[camera]\ndriver = \"v4l2\"\n[imu]\ndriver = \"iio\"\n"
      "[iio]\ndevice = \"bmi160\"\nrate_hz = 400\n",
      "[iio]\nrate_hz = 100\n");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->imu.iio.device, "bmi160");
  EXPECT_EQ(read->imu.iio.rate_hz, 100);
}

TEST_F(ConfigurationTest, ACalibrationLiesBesideTheFileThatNamesIt) {
  folder_.write("lenses/wide.toml", "[camera]\n");
  const auto read = load(
      "outputs = [\"-\"]\n[camera]\ndriver = \"v4l2\"\ncalibration = \"lenses/wide.toml\"\n"
      "[imu]\ndriver = \"iio\"\n");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->calibration.file, folder_.path() / "lenses/wide.toml");
}

}  // namespace
}  // namespace gimbal
