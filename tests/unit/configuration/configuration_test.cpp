#include "daemon/configuration.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <numbers>
#include <string>
#include <variant>

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

TEST_F(ConfigurationTest, RefusesAnOutputThatNeverCouldBeOpened) {
  const auto read = load(
      "outputs = [\"-\", \"/videos/front.avi\"]\n[camera]\ndriver = \"v4l2\"\n"
      "[imu]\ndriver = \"iio\"\n");
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("outputs /videos/front.avi: cannot tell what to write"),
            std::string::npos)
      << read.error().message;
  EXPECT_EQ(read.error().kind, Error::Kind::bad_input);
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

constexpr const char* kDevices = "[camera]\ndriver = \"v4l2\"\n[imu]\ndriver = \"iio\"\n";

TEST_F(ConfigurationTest, OutputsAreTextsAndPresets) {
  const auto read = load(std::string("outputs = [\"-\"]\n") + kDevices +
                         "[[output]]\npreset = \"rtsp\"\nport = 9000\npath = \"/front\"\n"
                         "[[output]]\npreset = \"file\"\nfolder = \"/videos\"\nsegment_s = 60\n"
                         "keep = 10\n[[output]]\npreset = \"stdout\"\nformat = \"raw\"\n");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->outputs.size(), 4U);
  EXPECT_EQ(std::get<TextOutput>(read->outputs[0]).text, "-");
  EXPECT_EQ(std::get<RtspOutput>(read->outputs[1]).port, 9000);
  EXPECT_EQ(std::get<RtspOutput>(read->outputs[1]).path, "/front");
  EXPECT_EQ(std::get<RtspOutput>(read->outputs[1]).address, "127.0.0.1");
  EXPECT_EQ(std::get<SegmentOutput>(read->outputs[2]).folder, "/videos");
  EXPECT_EQ(std::get<SegmentOutput>(read->outputs[2]).length, std::chrono::seconds(60));
  EXPECT_EQ(std::get<SegmentOutput>(read->outputs[2]).kept, 10);
  EXPECT_TRUE(std::holds_alternative<RawStdoutOutput>(read->outputs[3]));
}

TEST_F(ConfigurationTest, OutputsOfALaterFileGoInsteadOfAnEarlierOnes) {
  const auto read =
      load(std::string("outputs = [\"-\"]\n") + kDevices, "[[output]]\npreset = \"display\"\n");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->outputs.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<DisplayOutput>(read->outputs[0]));
}

struct BadOutput {
  const char* name;
  const char* lines;  ///< of the table, which begins in line 6
  const char* message;
};

class BadOutputTest : public ConfigurationTest, public ::testing::WithParamInterface<BadOutput> {};

TEST_P(BadOutputTest, IsNamedWithFileAndLine) {
  const auto read = load(std::string("\n") + kDevices + "[[output]]\n" + GetParam().lines);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("a.toml, line "), std::string::npos) << read.error().message;
  EXPECT_NE(read.error().message.find(GetParam().message), std::string::npos)
      << read.error().message;
}

INSTANTIATE_TEST_SUITE_P(
    Outputs, BadOutputTest,
    ::testing::Values(
        BadOutput{"NoPreset", "port = 1\n", "output.preset is missing"},
        BadOutput{"UnknownPreset", "preset = \"rtmp\"\n", "allowed are \"stdout\", \"file\""},
        BadOutput{"NoFolder", "preset = \"file\"\n", "output.folder is missing"},
        BadOutput{"NoDevice", "preset = \"v4l2loopback\"\n", "output.device is missing"},
        BadOutput{"NoSocket", "preset = \"shm\"\n", "output.socket is missing"},
        BadOutput{"Port", "preset = \"rtsp\"\nport = 70000\n", "a whole number from 1 to 65535"},
        BadOutput{"Path", "preset = \"rtsp\"\npath = \"x\"\n", "must begin with /"},
        BadOutput{"Key", "preset = \"udp\"\nprot = 1\n", "is output.port meant?"},
        BadOutput{"NoPipeline", "preset = \"pipeline\"\ntext = \"fakesink\"\n", "has no \" ! \""}),
    [](const auto& bad) -> std::string { return bad.param.name; });

TEST_F(ConfigurationTest, RecordingAndItsButton) {
  const auto read = load(std::string("outputs = [\"-\"]\n") + kDevices +
                         "[recording]\nfolder = \"/takes\"\nmin_free_mb = 5\n"
                         "[gpio]\nrecord_button = \"gpiochip0:17\"\n"
                         "record_button_active_low = false\nstatus_led = \"gpiochip1:2\"\n");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->recording.folder, "/takes");
  EXPECT_EQ(read->recording.min_free_mb, 5U);
  EXPECT_EQ(read->gpio.record_button, "gpiochip0:17");
  EXPECT_EQ(read->gpio.record_button_polarity, GpioPolarity::active_high);
  EXPECT_EQ(read->gpio.status_led, "gpiochip1:2");
  const auto wrong =
      load(std::string("outputs = [\"-\"]\n") + kDevices + "[gpio]\nstatus_led = \"17\"\n");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message.find("is not of the form gpiochip0:17"), std::string::npos);
}

TEST_F(ConfigurationTest, HowPicturesAreDrawn) {
  const std::string begin = std::string("outputs = [\"-\"]\n") + kDevices + "[stabilization]\n";
  const auto plain = load(begin);
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_FALSE(plain->stabilization.threads);
  EXPECT_EQ(plain->stabilization.interpolation, Interpolation::bilinear);
  EXPECT_EQ(plain->stabilization.output_lens, OutputLens::rectilinear);
  EXPECT_EQ(plain->stabilization.dma_bufs, DmaBufUse::on_gpus);
  EXPECT_EQ(load(begin + "dma_buf = \"never\"\n")->stabilization.dma_bufs, DmaBufUse::never);
  const auto kept =
      load(begin + "threads = 3\ninterpolation = \"bicubic\"\noutput_lens = \"kept\"\n");
  ASSERT_TRUE(kept) << kept.error().message;
  EXPECT_EQ(kept->stabilization.threads, 3);
  EXPECT_EQ(kept->stabilization.interpolation, Interpolation::bicubic);
  EXPECT_EQ(kept->stabilization.output_lens, OutputLens::kept);
  EXPECT_EQ(load(begin + "output_fov_deg = 95.5\n")->stabilization.output_fov_deg, 95.5);
  const auto level = load(begin + "horizon = \"soft\"\nhorizon_range_deg = 90\n");
  ASSERT_TRUE(level) << level.error().message;
  EXPECT_EQ(level->stabilization.lock.horizon, Horizon::soft);
  EXPECT_NEAR(level->stabilization.lock.most_roll_rad, std::numbers::pi / 2, 1e-12);
  const auto breathing = load(begin + "zoom_limits = [1.05, 1.4]\nzoom_speed_per_s = 0.02\n");
  ASSERT_TRUE(breathing) << breathing.error().message;
  EXPECT_EQ(breathing->stabilization.zoom_limits, (ZoomLimits{1.05, 1.4}));
  EXPECT_EQ(breathing->stabilization.zoom_speed_per_s, 0.02);
  for (const char* wrong :
       {"zoom_limits = [1.4, 1.0]\n", "zoom_limits = [0.9, 1.0]\n", "zoom_limits = [1.2]\n",
        "zoom_limits = 1.2\n", "zoom = 1.2\nzoom_limits = [1.0, 1.4]\n",
        "border = \"fill\"\nzoom_limits = [1.0, 1.4]\n", "zoom_speed_per_s = 0\n",
        "path = \"hann\"\nzoom_speed_per_s = 0.1\n", "horizon = \"level\"\n",
        "horizon_range_deg = 181\n", "path = \"hann\"\nhorizon = \"hard\"\n", "threads = 0\n",
        "threads = 65\n", "interpolation = \"nearest\"\n", "output_lens = \"fisheye\"\n",
        "dma_buf = \"yes\"\n", "output_fov_deg = 151\n",
        "output_lens = \"kept\"\noutput_fov_deg = 90\n"}) {
    EXPECT_FALSE(load(begin + wrong)) << wrong;
  }
}

TEST_F(ConfigurationTest, AnOutputThatIsNoTableIsRefused) {
  const auto read = load(std::string("output = \"rtsp\"\n") + kDevices);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("tables [[output]]"), std::string::npos)
      << read.error().message;
}

}  // namespace
}  // namespace gimbal
