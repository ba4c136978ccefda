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

class CalibrateImu : public ::testing::Test {
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

TEST_F(CalibrateImu, TellsBiasNoiseAndTheAccelerometersErrors) {
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

TEST_F(CalibrateImu, CannotTellFromAHand) {
  simulate("walk");
  const auto run = gimbalctl({"calibrate", "imu", path("session"), "--json"});
  EXPECT_EQ(run.exit_status, 2);
  EXPECT_EQ(Json::parse(run.standard_output)["verdict"], "cannot-tell");
  EXPECT_THAT(run.standard_error, HasSubstr("lies still"));
}

}  // namespace
}  // namespace gimbal
