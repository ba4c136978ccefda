// gimbalctl calibrate, as scripts call it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/run_program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr int kLimit_s = 60;

test::ProgramRun gimbalctl(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), GIMBALCTL);
  return test::run_program(arguments, kLimit_s);
}

class Calibrate : public ::testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_.path() / name).string();
  }

  void simulate(const std::string& motion) const {
    const auto run = gimbalctl({"simulate", "-o", path("session"), "--motion", motion, "--size",
                                "64x36", "--fps", "2", "--duration", "40", "--gyro-bias",
                                "0.01,-0.02,0.03", "--gyro-noise", "2e-4", "--quiet"});
    ASSERT_EQ(run.exit_status, 0) << run.standard_error;
  }

  /// An accelerometer that reads 2 % too much and 0.1 m/s² more along x, on each face for two
  /// seconds.
  void write_faces() const {
    std::ostringstream accel;
    std::ostringstream gyro;
    accel << "t_s,x,y,z\n";
    gyro << "t_s,x,y,z\n";
    for (int i = 0; i < 6 * 300; ++i) {
      std::array<double, 3> force = {0.1, 0, 0};
      const int face = i / 300;
      force.at(static_cast<std::size_t>(face / 2)) += 1.02 * (face % 2 == 0 ? 9.80665 : -9.80665);
      accel << 0.01 * i << "," << force[0] << "," << force[1] << "," << force[2] << "\n";
      gyro << 0.01 * i << "," << (i % 300 < 200 ? 0 : 1.5) << ",0,0\n";
    }
    folder_.write("faces/session.toml", "device = \"board\"\n");
    folder_.write("faces/accel.csv", accel.str());
    folder_.write("faces/gyro.csv", gyro.str());
  }

  test::TemporaryFolder folder_;
};

TEST_F(Calibrate, TellsBiasNoiseAndTheAccelerometersErrors) {
  simulate("tripod");
  write_faces();
  const auto run = gimbalctl({"calibrate", "imu", path("session"), "--faces", path("faces"),
                              "--json", "--plot", path("allan.svg")});
  ASSERT_EQ(run.exit_status, 0) << run.standard_error;
  const Json found = Json::parse(run.standard_output);
  EXPECT_EQ(found["verdict"], "ok");
  EXPECT_NEAR(found["gyro_bias_rad_s"][0], 0.01, 1e-4);
  EXPECT_NEAR(found["gyro_bias_rad_s"][1], -0.02, 1e-4);
  EXPECT_NEAR(found["gyro_noise_rad_s_rthz"][2], 2e-4 / std::sqrt(2), 0.15e-4);
  EXPECT_NEAR(found["accel_scale"][1], 1.02, 1e-4);
  EXPECT_NEAR(found["accel_bias_m_s2"][0], 0.1, 1e-3);
  EXPECT_TRUE(fs::exists(path("allan.svg")));
}

TEST_F(Calibrate, KeepsAPlotThatIsThereUnlessItMayGo) {
  simulate("tripod");
  folder_.write("mine.svg", "mine");
  const std::vector<std::string> draw = {"calibrate", "imu", path("session"), "--plot",
                                         path("mine.svg")};
  const auto refused = gimbalctl(draw);
  EXPECT_EQ(refused.exit_status, 2);
  EXPECT_THAT(refused.standard_error, HasSubstr("mine.svg: is there already"));
  EXPECT_EQ(fs::file_size(path("mine.svg")), 4U);
  std::vector<std::string> replace = draw;
  replace.emplace_back("--overwrite");
  EXPECT_EQ(gimbalctl(replace).exit_status, 0);
  EXPECT_GT(fs::file_size(path("mine.svg")), 100U);
  EXPECT_THAT(gimbalctl({"calibrate", "readout", "--hz", "407", path("session"), "--plot",
                         path("mine.svg")})
                  .standard_error,
              HasSubstr("is there already"));
}

/// Frames of a surface that a square wave of light shines on, each line exposed for 0.4 ms: 64 x
/// 240 in y4m, luma by BT.709's transfer.
std::string flashing_video(double light_hz, double readout_s) {
  constexpr int kWidth = 64;
  constexpr int kLines = 240;
  constexpr int kStepsOfExposure = 40;
  constexpr double kExposure_s = 0.4e-3;
  std::string video = "YUV4MPEG2 W64 H240 F30:1 Ip A1:1 C420 XCOLORRANGE=FULL\n";
  for (int frame = 0; frame < 45; ++frame) {
    video += "FRAME\n";
    for (int line = 0; line < kLines; ++line) {
      int lit = 0;
      for (int step = 0; step < kStepsOfExposure; ++step) {
        const double time_s =
            10 + frame / 30.0 + readout_s * line / kLines - kExposure_s * step / kStepsOfExposure;
        lit += std::fmod(time_s * light_hz, 1.0) < 0.5 ? 1 : 0;
      }
      const double light = 0.1 + 0.6 * lit / kStepsOfExposure;
      const double signal = 1.099 * std::pow(light, 0.45) - 0.099;
      video += std::string(kWidth, static_cast<char>(std::lround(255 * signal)));
    }
    video += std::string(kWidth * kLines / 2, '\x80');
  }
  return video;
}

// The recording has no calibration at all: neither lens nor gyroscope is needed.
TEST_F(Calibrate, TellsTheReadoutOfAFlashingLight) {
  std::ostringstream frames;
  frames << "index,t_s\n";
  for (int frame = 0; frame < 45; ++frame) frames << frame << "," << 10 + frame / 30.0 << "\n";
  // What a file holds is told by its content, not by its name.
  folder_.write("light/video.mkv", flashing_video(407, 0.0241));
  folder_.write("light/session.toml", "device = \"board\"\n");
  folder_.write("light/frames.csv", frames.str());
  const auto run = gimbalctl({"calibrate", "readout", path("light"), "--hz", "407", "--json",
                              "--plot", path("bands.svg"), "--write", path("found.toml")});
  ASSERT_EQ(run.exit_status, 0) << run.standard_error;
  const Json found = Json::parse(run.standard_output);
  EXPECT_NEAR(found["readout_s"], 0.0241, 0.01 * 0.0241);
  EXPECT_NEAR(found["exposure_s"], 0.4e-3, 0.1e-3);
  EXPECT_TRUE(fs::exists(path("bands.svg")));
  EXPECT_TRUE(fs::exists(path("found.toml")));
  const auto again = gimbalctl(
      {"calibrate", "readout", path("light"), "--hz", "407", "--write", path("found.toml")});
  EXPECT_EQ(again.exit_status, 2);
  EXPECT_THAT(again.standard_error, HasSubstr("is there already"));
  EXPECT_EQ(gimbalctl({"calibrate", "readout", path("light"), "--hz", "300.7"}).exit_status, 2);
}

TEST_F(Calibrate, FlashesNoLightThatThereIsNot) {
  const auto refusal = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"calibrate", "readout", "--hz", "407"});
    const auto run = gimbalctl(arguments);
    EXPECT_EQ(run.exit_status, 2);
    return run.standard_error;
  };
  EXPECT_THAT(refusal({}), HasSubstr("--gpio"));
  EXPECT_THAT(refusal({"--gpio", "gpiochip0:3"}), HasSubstr("--camera"));
  EXPECT_THAT(refusal({path("session"), "--gpio", "gpiochip0:3", "--camera", "/dev/video0"}),
              HasSubstr("session"));
  EXPECT_THAT(refusal({"--gpio", "no-chip:3", "--camera", "/dev/no-camera"}), HasSubstr("gpio"));
}

TEST_F(Calibrate, CannotTellFromAHand) {
  simulate("walk");
  const auto run = gimbalctl({"calibrate", "imu", path("session"), "--json"});
  EXPECT_EQ(run.exit_status, 2);
  EXPECT_EQ(Json::parse(run.standard_output)["verdict"], "cannot-tell");
  EXPECT_THAT(run.standard_error, HasSubstr("lies still"));
}

}  // namespace
}  // namespace gimbal
