// The daemon as a person starts it: a recording that is played at its own pace, steady pictures
// out.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "drivers/replay/video_probe.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr int kLimit_s = 100;

/// The numbers that a pattern's groups match.
template <std::size_t count>
std::array<long, count> counts_in(const std::string& text, const char* pattern) {
  std::array<long, count> counts{};
  std::smatch match;
  if (!std::regex_search(text, match, std::regex(pattern))) {
    ADD_FAILURE() << text;
    return counts;
  }
  for (std::size_t i = 0; i < count; ++i) counts[i] = std::stol(match[i + 1]);
  return counts;
}

class Gimbald : public ::testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_.path() / name).string();
  }

  [[nodiscard]] test::ProgramRun run(const std::string& configuration,
                                     std::vector<std::string> more = {}) const {
    folder_.write("gimbald.toml", configuration);
    std::vector<std::string> command = {GIMBALD, "--config", path("gimbald.toml")};
    command.insert(command.end(), more.begin(), more.end());
    return test::run_program(command, kLimit_s);
  }

  /// Makes the folder "session".
  void simulate_walk(const char* duration_s) const {
    const auto simulated =
        test::run_program({GIMBALCTL, "simulate", "-o", path("session"), "--size", "320x240",
                           "--duration", duration_s, "--motion", "walk", "--quiet"},
                          kLimit_s);
    ASSERT_EQ(simulated.exit_status, 0) << simulated.standard_error;
  }

  test::TemporaryFolder folder_;
};

TEST_F(Gimbald, PlaysARecordingToItsEndAndFinishesTheFile) {
  ASSERT_NO_FATAL_FAILURE(simulate_walk("2"));
  const auto played =
      run("outputs = [\"" + path("out.mkv") + "\"]\n[replay]\nsession = \"" + path("session") +
          "\"\nrepeat = false\n[stabilization]\nwarper = \"cpu\"\n");
  ASSERT_EQ(played.exit_status, 0) << played.standard_error;
  EXPECT_THAT(played.standard_error, HasSubstr("60 frames in"));
#ifdef GIMBALD_HAS_CORNERS
  EXPECT_THAT(played.standard_error, Not(HasSubstr("the time offset is not tracked")));
#endif
  // On a busy machine a frame may be dropped, but then it is counted.
  const auto video = probe_video(path("out.mkv"));
  ASSERT_TRUE(video) << video.error().message;
  EXPECT_GT(video->frame_count, 0);
  const auto [out, without_orientation, before_drawing] =
      counts_in<3>(played.standard_error,
                   R"((\d+) out, (\d+) dropped for want of orientation, (\d+) before drawing)");
  EXPECT_EQ(out + without_orientation + before_drawing, 60);
  const auto [written, dropped] =
      counts_in<2>(played.standard_error, R"((\d+) frames written, (\d+) dropped)");
  EXPECT_EQ(written + dropped, out);
  EXPECT_THAT(played.standard_error,
              HasSubstr(std::to_string(video->frame_count) + " frames written"));
}

// As the frame list has it, which tells of more pictures than there are.
TEST_F(Gimbald, SaysOnceThatARecordingIsCutShort) {
  ASSERT_NO_FATAL_FAILURE(simulate_walk("1"));
  std::ofstream(path("session/frames.csv"), std::ios::app)
      << "30,2.000000000,0.004\n31,2.033333333,0.004\n";
  const auto played =
      run("outputs = [\"" + path("out.y4m") + "\"]\n[replay]\nsession = \"" + path("session") +
          "\"\nrepeat = false\n[stabilization]\nwarper = \"cpu\"\n");
  ASSERT_EQ(played.exit_status, 0) << played.standard_error;
  const auto said = played.standard_error.find("last 2 stamps");
  ASSERT_NE(said, std::string::npos) << played.standard_error;
  EXPECT_EQ(played.standard_error.find("last 2 stamps", said + 1), std::string::npos);
}

TEST_F(Gimbald, SaysWhatIsWrongWithAConfiguration) {
  struct Case {
    std::string text, said;
  };
  const std::string replay = "outputs = [\"-\"]\n[replay]\nsession = \"here\"\n";
  const std::string live =
      "outputs = [\"-\"]\n[camera]\ndriver = \"v4l2\"\n[imu]\ndriver = \"iio\"\n";
  for (const Case& c : std::vector<Case>{
           {"outputs = [\"-\"]\n", "no camera is configured"},
           {"[replay]\nsession = \"here\"\n", "no output is configured"},
           {"outputs = \"-\"\n", "line 1: outputs is \"-\"; a list of texts in quotes is expected"},
           {"output = [\"-\"]\n", "line 1: output is \"[ '-' ]\"; tables [[output]] is expected"},
           {"outputz = [\"-\"]\n", "line 1: \"outputz\" is not known; is outputs meant?"},
           {replay + "repaet = true\n",
            "line 4: replay.\"repaet\" is not known; is replay.repeat meant?"},
           {replay + "[imu]\nbias_kept_days = 0\n", "line 5: imu.bias_kept_days must be above 0"},
           {replay + "[sync]\ncpu_share = 0\n", "line 5: sync.cpu_share must be above 0"},
           {replay + "repeat = 1\n", "line 4: replay.repeat is \"1\"; true or false is expected"},
           {replay + "[stabilization]\namount = 2\n", "stabilization.amount must be from 0 to 1"},
           {replay + "[stabilization]\nzoom = \"big\"\n", "zoom must be \"auto\" or a ratio"},
           {replay + "[stabilization]\nzoom = 0.5\n", "zoom must be from 1 to 10"},
           {replay + "[stabilization]\nborder = \"fancy\"\n", "stabilization.border"},
           {replay + "[stabilization]\nlatency_frames = -1\n", "stabilization.latency_frames"},
           {replay + "[camera]\ndriver = \"v4l3\"\n", "camera.driver"},
           {live + "[v4l2]\nwidth = 640\n", "line 7: v4l2.width needs height beside it"},
           {live + "[v4l2]\nfps = 0\n", "v4l2.fps is 0; 0.1 to 1000 is allowed"},
           {live + "[v4l2.controls]\nexposure = \"long\"\n",
            "line 7: v4l2.controls.exposure is \"long\"; a whole number is expected"},
           {live + "[iio]\nrate = 100\n", "iio.\"rate\" is not known; is iio.rate_hz meant?"},
           {live + "[i2c]\naccel_range_g = 4\n", "accel_range_g is 4; 8 and 16 are allowed"},
           {live + "[i2c]\naddress = 200\n", "i2c.address"},
           {"outputs = [\"-\"]\n[camera]\ndriver = \"v4l2\"\n", "do not go together"},
           {"outputs = [\"-\"]\n[camera]\ncalibration = \"none.toml\"\n",
            "line 3: camera.calibration is not there"},
           {"outputs = [\"-\"]\n[camera]\nhorizontal_fov_deg = 200\n", "must be from 1 to 170"},
           {"outputs = [\"-\"]\n[imu]\nR_camera_imu = [[1,0,0],[0,1,0],[0,0,2]]\n",
            "is not a rotation"},
           {"outputs = [\"-\"]\n[camera]\ndriver = \"v4l2\"\n[imu]\ndriver = \"iio\"\n",
            "the lens is not known: give calibration = FILE"},
           {"outputs = [", "line 1"}}) {
    const auto checked = run(c.text, {"--check-config"});
    EXPECT_EQ(checked.exit_status, 2) << c.text;
    EXPECT_THAT(checked.standard_error, HasSubstr(c.said));
    EXPECT_EQ(test::lines_starting_with(checked.standard_error, "").size(), 1U);
  }
}

TEST_F(Gimbald, ALaterFileOverridesSingleKeys) {
  folder_.write("more.toml", "[stabilization]\namount = 0.5\n");
  const auto checked = run("outputs = [\"-\"]\n[replay]\nsession = \"here\"\n",
                           {"--config", path("more.toml"), "--check-config"});
  EXPECT_EQ(checked.exit_status, 0) << checked.standard_error;
  EXPECT_EQ(checked.standard_error, "");
}

TEST_F(Gimbald, TheExamplesAreSound) {
  namespace fs = std::filesystem;
  const fs::path folder = GIMBALD_CONFIG;
  for (const auto& example : fs::directory_iterator(folder / "examples")) {
    const auto checked = test::run_program(
        {GIMBALD, "--config", example.path().string(), "--check-config"}, kLimit_s);
    EXPECT_EQ(checked.exit_status, 0) << checked.standard_error;
  }
  for (const auto& more : fs::directory_iterator(folder / "conf.d.examples")) {
    const auto checked =
        test::run_program({GIMBALD, "--config", (folder / "examples/replay.toml").string(),
                           "--config", more.path().string(), "--check-config"},
                          kLimit_s);
    EXPECT_EQ(checked.exit_status, 0) << checked.standard_error;
  }
}

TEST_F(Gimbald, TakesOverChangesOnSighupAndRefusesBrokenOnes) {
  ASSERT_NO_FATAL_FAILURE(simulate_walk("1"));
  folder_.write("run.toml", "outputs = [\"" + path("out.y4m") + "\"]\n[replay]\nsession = \"" +
                                path("session") + "\"\n");
  folder_.write("more.toml", "");
  const std::string script =
      "comes() { for i in $(seq 300); do \"$@\" > /dev/null 2>&1 && return; sleep 0.1; done; }\n"
      "\"$0\" --config run.toml --config more.toml 2> log & daemon=$!; comes test -s out.y4m\n"
      "echo '[stabilization]\namount = 5' > more.toml; kill -HUP $daemon\n"
      "comes grep 'not reloaded' log\n"
      "echo '[stabilization]\namount = 0.5' > more.toml; kill -HUP $daemon\n"
      "comes grep 'reloaded: amount' log\n"
      "kill -TERM $daemon; wait $daemon; status=$?; cat log >&2; exit $status";
  const auto ran = test::run_program(
      {"sh", "-c", "cd '" + folder_.path().string() + "'\n" + script, GIMBALD}, kLimit_s);
  EXPECT_EQ(ran.exit_status, 0) << ran.standard_error;
  EXPECT_THAT(
      ran.standard_error,
      HasSubstr("not reloaded: more.toml, line 2: stabilization.amount must be from 0 to 1"));
  EXPECT_THAT(ran.standard_error, HasSubstr("reloaded: amount"));
  EXPECT_THAT(ran.standard_error, HasSubstr("0 dropped for want of orientation"));
}

TEST_F(Gimbald, RemembersTheGyroscopesBiasUntilTheNextRun) {
  ASSERT_NO_FATAL_FAILURE(simulate_walk("1"));
  const auto play = [&] {
    const auto played = run("outputs = [\"" + path("out.y4m") + "\"]\n[replay]\nsession = \"" +
                            path("session") + "\"\nrepeat = false\n[imu]\nbias_file = \"" +
                            path("bias.toml") + "\"\n[stabilization]\nwarper = \"cpu\"\n");
    EXPECT_EQ(played.exit_status, 0);
    return played.standard_error;
  };
  constexpr auto kRecalls = "the gyroscope's bias was ";
  EXPECT_THAT(play(), Not(HasSubstr(kRecalls)));
  EXPECT_THAT(play(), HasSubstr(kRecalls));
  folder_.write("bias.toml", "spoilt");
  const std::string log = play();
  EXPECT_THAT(log, HasSubstr("bias.toml"));
  EXPECT_THAT(log, HasSubstr("learned anew"));
  EXPECT_THAT(log, Not(HasSubstr(kRecalls)));
  EXPECT_THAT(play(), HasSubstr(kRecalls));
}

TEST_F(Gimbald, ASessionThatIsNotThereIsBadInput) {
  const auto started = run("outputs = [\"-\"]\n[replay]\nsession = \"" + path("none") + "\"\n");
  EXPECT_EQ(started.exit_status, 2);
  EXPECT_THAT(started.standard_error, StartsWith("gimbald: "));
  EXPECT_THAT(started.standard_error, HasSubstr("no such session"));
}

}  // namespace
}  // namespace gimbal
