// The command line as scripts call it: what it writes, and what the files say.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/replay/video_probe.hpp"
#include "pipeline/path/horizon.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kLimit_s = 100;

test::ProgramRun gimbalctl(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), GIMBALCTL);
  return test::run_program(arguments, kLimit_s);
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

class Gimbalctl : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto run = gimbalctl({"simulate", "-o", session(), "--size", "320x240", "--duration",
                                "1.5", "--motion", "walk", "--quiet"});
    ASSERT_EQ(run.exit_status, 0) << run.standard_error;
  }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_.path() / name).string();
  }
  [[nodiscard]] std::string session() const { return path("session"); }

  /// The report of a run that must succeed.
  [[nodiscard]] Json stabilize(const std::vector<std::string>& options) const {
    return stabilize_with({"--warper", "cpu"}, options);
  }

  [[nodiscard]] Json stabilize_with(const std::vector<std::string>& warper,
                                    const std::vector<std::string>& options) const {
    std::vector<std::string> arguments = {"stabilize", session(), "--report", path("report.json")};
    arguments.insert(arguments.end(), warper.begin(), warper.end());
    arguments.insert(arguments.end(), options.begin(), options.end());
    const auto run = gimbalctl(arguments);
    EXPECT_EQ(run.exit_status, 0) << run.standard_error;
    return Json::parse(std::ifstream(path("report.json")));
  }

  test::TemporaryFolder folder_;
};

TEST_F(Gimbalctl, StabilizesWithALogAndAReport) {
  const Json report = stabilize({"-o", path("out.mp4"), "--path-log", path("path.csv")});
  const auto video = probe_video(path("out.mp4"));
  ASSERT_TRUE(video) << video.error().message;
  const auto frames = lines_of(fs::path(session()) / "frames.csv").size() - 1;
  EXPECT_EQ(report["frames"]["in"], frames);
  EXPECT_EQ(report["frames"]["out"], frames);
  EXPECT_EQ(report["border_px"]["total"], 0);
  EXPECT_EQ(report["warper"], "cpu");
  EXPECT_GT(report["mesh"]["error_bound_px"], 0);
  EXPECT_LE(report["mesh"]["error_bound_px"], 0.1);
  EXPECT_EQ(report["mesh"]["frames_of_unknown_error"], 0);
  EXPECT_GE(report["zoom"], 1);
  EXPECT_LT(report["rms_rate_above_1hz_rad_s"]["after"],
            report["rms_rate_above_1hz_rad_s"]["before"]);
  const auto log = lines_of(path("path.csv"));
  ASSERT_EQ(log.size(), frames + 1);
  EXPECT_EQ(log.front(), "index,t_s,qw,qx,qy,qz,fx,fy,cx,cy,border_px");
  EXPECT_EQ(std::count(log.back().begin(), log.back().end(), ','), 10);
}

/// The orientation in a line of a path log.
Eigen::Quaterniond orientation_in(const std::string& line) {
  std::istringstream fields(line);
  std::vector<double> numbers;
  for (std::string field; std::getline(fields, field, ',');) numbers.push_back(std::stod(field));
  return {numbers.at(2), numbers.at(3), numbers.at(4), numbers.at(5)};
}

TEST_F(Gimbalctl, WithoutAnAccelerometerTheWorldIsTheFirstFramesCamera) {
  const std::vector<std::string> options = {
      "-o",       path("out.mkv"), "--rectify-only", "--zoom",        "1",
      "--border", "black",         "--path-log",     path("path.csv")};
  (void)stabilize(options);
  const auto upright = lines_of(path("path.csv"));
  fs::remove(fs::path(session()) / "accel.csv");
  (void)stabilize(options);
  const auto log = lines_of(path("path.csv"));
  ASSERT_EQ(log.size(), upright.size());
  const Eigen::Quaterniond q_first = orientation_in(log[1]);
  EXPECT_LT(q_first.angularDistance(Eigen::Quaterniond::Identity()), 1e-6);
  // The same turns as in a world whose z is up, but for what the accelerometer corrects.
  const Eigen::Quaterniond q_up_first = orientation_in(upright[1]);
  EXPECT_GT(q_up_first.angularDistance(Eigen::Quaterniond::Identity()), 0.1);
  for (std::size_t i = 1; i < log.size(); ++i) {
    const Eigen::Quaterniond turn = q_up_first.conjugate() * orientation_in(upright[i]);
    EXPECT_LT(turn.angularDistance(orientation_in(log[i])), 0.02) << log[i];
  }
}

double roll_deg(const std::string& line) {
  return std::abs(roll_rad(orientation_in(line))) * 180 / std::numbers::pi;
}

TEST_F(Gimbalctl, AHardHorizonIsLevelInEachFrame) {
  const Json report =
      stabilize({"-o", path("out.mkv"), "--horizon", "hard", "--path-log", path("path.csv")});
  EXPECT_EQ(report["horizon"], "hard");
  EXPECT_EQ(report["border_px"]["total"], 0);
  const auto log = lines_of(path("path.csv"));
  for (std::size_t i = 1; i < log.size(); ++i) EXPECT_LT(roll_deg(log[i]), 0.1) << log[i];
}

TEST_F(Gimbalctl, AHorizonThatNothingTellsIsRefused) {
  const auto refusal = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"stabilize", session(), "-o", path("out.mkv")});
    const auto run = gimbalctl(options);
    EXPECT_EQ(run.exit_status, 2);
    return run.standard_error;
  };
  EXPECT_THAT(refusal({"--horizon", "soft", "--path", "hann"}), testing::HasSubstr("--horizon"));
  EXPECT_THAT(refusal({"--horizon", "soft", "--rectify-only"}), testing::HasSubstr("--horizon"));
  fs::remove(fs::path(session()) / "accel.csv");
  EXPECT_THAT(refusal({"--horizon", "hard"}), testing::HasSubstr("no accelerometer"));
}

TEST_F(Gimbalctl, CopiesAreCounted) {
  const int frame_bytes = 320 * 240 * 3 / 2;
  const auto copied = [&](const std::string& out) {
    return stabilize({"-o", out})["bytes_copied_per_frame"];
  };
  // Planar pictures come from most decoders, and their chroma is interleaved once.
  const Json none = copied("queue ! fakesink");
  EXPECT_EQ(none["decode"], frame_bytes / 3);
  EXPECT_EQ(none["encode"], 0);
  EXPECT_EQ(copied("videoconvert ! video/x-raw,format=I420 ! fakesink")["encode"], frame_bytes);
  EXPECT_EQ(copied("videoconvert ! video/x-raw,format=NV12 ! fakesink")["encode"], 0);
  EXPECT_NEAR(copied(path("out.y4m"))["encode"].get<int>(), frame_bytes, 20) << "and headers";
}

TEST_F(Gimbalctl, ThreadsAndInterpolationAreAsAsked) {
  const Json plain = stabilize({"-o", path("plain.y4m"), "--threads", "1"});
  EXPECT_EQ(plain["interpolation"], "bilinear");
  EXPECT_THAT(plain["renderer"].get<std::string>(), testing::EndsWith("threads: 1"));
  const Json sharp =
      stabilize({"-o", path("sharp.y4m"), "--threads", "3", "--interpolation", "bicubic"});
  EXPECT_EQ(sharp["interpolation"], "bicubic");
  EXPECT_THAT(sharp["renderer"].get<std::string>(), testing::EndsWith("threads: 3"));
  EXPECT_NE(lines_of(path("plain.y4m")), lines_of(path("sharp.y4m")));
  for (const char* threads : {"0", "65", "two"}) {
    EXPECT_EQ(gimbalctl({"stabilize", session(), "-o", "-", "--threads", threads}).exit_status, 2);
  }
}

TEST_F(Gimbalctl, TheOutputsLensIsAsAsked) {
  const Json kept = stabilize({"-o", path("kept.y4m"), "--output-lens", "kept"});
  EXPECT_EQ(kept["border_px"]["total"], 0);
  const auto focal_length = [&](const std::vector<std::string>& options) {
    std::vector<std::string> all = {"-o", path("out.y4m"), "--path-log", path("path.csv"), "--zoom",
                                    "1",  "--border",      "black"};
    all.insert(all.end(), options.begin(), options.end());
    EXPECT_EQ(stabilize(all)["zoom"], 1);
    std::istringstream fields(lines_of(path("path.csv")).at(1));
    std::string field;
    for (int i = 0; i < 7; ++i) std::getline(fields, field, ',');
    return std::stod(field);
  };
  EXPECT_NEAR(focal_length({"--output-fov", "90"}), 160, 1e-6) << "half of 320 pixels";
  EXPECT_GT(focal_length({}), 200);
  const auto both = gimbalctl({"stabilize", session(), "-o", path("no.y4m"), "--output-lens",
                               "kept", "--output-fov", "90"});
  EXPECT_EQ(both.exit_status, 2);
  EXPECT_THAT(both.standard_error, testing::HasSubstr("--output-fov"));
}

TEST_F(Gimbalctl, BordersAreFilledFromOtherFrames) {
  const auto border_px = [&](const std::vector<std::string>& options) {
    std::vector<std::string> all = {"-o", path("out.y4m"), "--path-log", path("path.csv"),
                                    "--border"};
    all.insert(all.end(), options.begin(), options.end());
    const double total = stabilize(all)["border_px"]["total"];
    double logged = 0;
    const std::vector<std::string> lines = lines_of(path("path.csv"));
    for (std::size_t i = 1; i < lines.size(); ++i) {
      logged += std::stod(lines[i].substr(lines[i].rfind(',') + 1));
    }
    EXPECT_EQ(logged, total);
    return total;
  };
  const double black = border_px({"black"});
  const double blurred = border_px({"blur"});
  const double filled = border_px({"fill"});
  const std::vector<std::string> first = lines_of(path("out.y4m"));
  EXPECT_GT(black, 0);
  EXPECT_GE(blurred, black) << "blurred is not filled";
  // How much less is the golden test's: this clip is mostly ends.
  EXPECT_LT(filled, 0.5 * black);
  EXPECT_LT(border_px({"fill", "--latency", "5"}), 0.5 * border_px({"black", "--latency", "5"}));
  EXPECT_EQ(border_px({"fill"}), filled);
  EXPECT_EQ(lines_of(path("out.y4m")), first);
}

TEST_F(Gimbalctl, AnAutomaticZoomHasLimitsAndASpeed) {
  const Json report = stabilize({"-o", path("out.y4m"), "--path-log", path("path.csv"),
                                 "--zoom-limits", "1.02..1.08", "--zoom-speed", "0.03"});
  EXPECT_LE(report["zoom_max"], 1.08 + 1e-9);
  EXPECT_EQ(report["border_px"]["total"], 0);
  const std::vector<std::string> lines = lines_of(path("path.csv"));
  std::vector<double> focal_px;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    std::istringstream fields(lines[i]);
    std::string field;
    for (int j = 0; j < 7; ++j) std::getline(fields, field, ',');
    focal_px.push_back(std::stod(field));
  }
  (void)stabilize({"-o", path("out.y4m"), "--path-log", path("path.csv"), "--zoom", "1"});
  std::istringstream fields(lines_of(path("path.csv")).at(1));
  std::string field;
  for (int j = 0; j < 7; ++j) std::getline(fields, field, ',');
  const double unzoomed_px = std::stod(field);
  for (std::size_t i = 0; i < focal_px.size(); ++i) {
    EXPECT_GE(focal_px[i] / unzoomed_px, 1.02 - 1e-6) << i;
    EXPECT_LE(focal_px[i] / unzoomed_px, 1.08 + 1e-6) << i;
    if (i == 0) continue;
    EXPECT_LE((focal_px[i] - focal_px[i - 1]) / unzoomed_px, 0.03 / 30 + 1e-5) << i;
  }
}

TEST_F(Gimbalctl, SoftwareGlesIsTakenOnlyWhenAskedFor) {
  ASSERT_EQ(setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1), 0);  // Mesa's; for the programs run from here
  const Json unset = stabilize_with({}, {"-o", path("out.mkv")});
  const Json asked = stabilize_with({"--warper", "gles"}, {"-o", path("out.mkv")});
  unsetenv("LIBGL_ALWAYS_SOFTWARE");
  EXPECT_EQ(unset["warper"], "cpu");
  EXPECT_TRUE(unset["gl_renderer"].is_null());
  EXPECT_EQ(unset["warnings"].size(), 0U);
  const std::string renderer = asked["gl_renderer"];
  EXPECT_EQ(asked["warper"], "gles");
  EXPECT_EQ(asked["warper_reason"], "asked for");
  // To the renderer's memory and back; what is drawn on the CPU is not copied.
  EXPECT_EQ(asked["bytes_copied_per_frame"]["warp"], 2 * 320 * 240 * 3 / 2);
  EXPECT_EQ(asked["transfers"], "in copied, out copied");
  EXPECT_EQ(unset["bytes_copied_per_frame"]["warp"], 0);
  EXPECT_EQ(unset["warper_reason"], "no GPU: GLES would draw with " + renderer);
}

TEST_F(Gimbalctl, RectifyingAloneLeavesTheMotionWhateverTheZoom) {
  for (const char* zoom : {"1", "1.3", "auto"}) {
    const Json report = stabilize({"-o", path("out.mkv"), "--rectify-only", "--zoom", zoom});
    const double before = report["rms_rate_above_1hz_rad_s"]["before"];
    const double after = report["rms_rate_above_1hz_rad_s"]["after"];
    EXPECT_NEAR(after, before, 1e-9) << zoom;
  }
}

TEST_F(Gimbalctl, TheFrameRateNeedNotBeGiven) {
  const Json given = stabilize({"-o", path("out.mkv")});
  std::string toml;
  for (const std::string& line : lines_of(fs::path(session()) / "session.toml")) {
    if (!line.starts_with("fps")) toml += line + "\n";
  }
  std::ofstream(fs::path(session()) / "session.toml") << toml;
  const Json not_given = stabilize({"-o", path("out.mkv")});
  EXPECT_EQ(not_given["rms_rate_above_1hz_rad_s"], given["rms_rate_above_1hz_rad_s"]);
}

TEST_F(Gimbalctl, AContainerIsTakenFromTheEndingInAnyCase) {
  (void)stabilize({"-o", path("OUT.MP4")});
  std::ifstream file(path("OUT.MP4"), std::ios::binary);
  std::string head(8, '\0');
  file.read(head.data(), 8);
  EXPECT_EQ(head.substr(4), "ftyp");
}

TEST_F(Gimbalctl, PicturesOnStandardOutputAreY4mAlone) {
  const auto run = gimbalctl({"stabilize", session(), "-o", "-", "--warper", "cpu"});
  EXPECT_EQ(run.exit_status, 0);
  EXPECT_EQ(run.standard_error, "");
  EXPECT_TRUE(run.standard_output.starts_with("YUV4MPEG2 W320 H240 "));
}

TEST_F(Gimbalctl, SteadyVideosAreListedWithTheirSession) {
  (void)stabilize({"-o", path("steady.mkv"), "--zoom", "1.25"});
  const auto shown = gimbalctl({"sessions", "show", "--json", session()});
  EXPECT_EQ(shown.exit_status, 0) << shown.standard_error;
  const Json listed = Json::parse(shown.standard_output)["stabilized"];
  ASSERT_EQ(listed.size(), 1U);
  EXPECT_NEAR(listed[0]["zoom"], 1.25, 1e-9);
  fs::remove(path("steady.mkv"));
  const auto gone = gimbalctl({"sessions", "show", "--json", session()});
  EXPECT_EQ(Json::parse(gone.standard_output)["stabilized"].size(), 0U);
}

TEST_F(Gimbalctl, VideosThatDifferInTheirEndingAloneHaveReportsOfTheirOwn) {
  const std::vector<std::pair<std::string, double>> zooms = {{"a.MP4", 1.1}, {"a.mkv", 1.2}};
  for (const auto& [name, zoom] : zooms) {
    (void)stabilize({"-o", path(name), "--zoom", std::to_string(zoom)});
  }
  const auto shown = gimbalctl({"sessions", "show", "--json", session()});
  const Json listed = Json::parse(shown.standard_output)["stabilized"];
  ASSERT_EQ(listed.size(), zooms.size());
  for (std::size_t i = 0; i < zooms.size(); ++i) {
    EXPECT_EQ(fs::path(listed[i]["video"]).filename(), zooms[i].first);
    EXPECT_NEAR(listed[i]["zoom"], zooms[i].second, 1e-9);
  }
}

/// Runs gimbalctl with its standard output into a pipe that nobody reads any more; what it said and
/// its status come on standard error. `redirection`: of the shell, such as "2>&1".
std::string said_without_reader(const std::vector<std::string>& arguments,
                                const std::string& redirection) {
  // The inner shell alone outlives writing to nobody: it waits until the reader has gone.
  const std::string script =
      "{ (trap '' PIPE; while echo; do sleep 0.01; done) 2>/dev/null; \"$@\" " + redirection +
      "; echo \"status $?\" >&2; } | :";
  std::vector<std::string> line = {"sh", "-c", script, "sh", GIMBALCTL};
  line.insert(line.end(), arguments.begin(), arguments.end());
  return test::run_program(line, kLimit_s).standard_error;
}

TEST_F(Gimbalctl, AReaderThatIsGoneEndsItInOneLine) {
  const std::vector<std::vector<std::string>> commands = {
      {"stabilize", session(), "-o", "-", "--warper", "cpu"},
      {"stabilize", session(), "-o", "y4menc ! fdsink", "--warper", "cpu"},
      {"orient", session(), "-o", "-"},
      {"sessions", "show", session()}};
  for (const std::vector<std::string>& command : commands) {
    const std::string said = said_without_reader(command, "");
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 2) << said;
    EXPECT_TRUE(said.starts_with("gimbalctl: ")) << said;
    EXPECT_TRUE(said.ends_with("\nstatus 1\n")) << said;
    EXPECT_EQ(said_without_reader(command, "2>&1"), "status 1\n");
  }
}

TEST_F(Gimbalctl, OrientationsComeAtTheGyrosStamps) {
  const auto gyro = lines_of(fs::path(session()) / "gyro.csv").size();
  for (const std::vector<std::string>& how : std::vector<std::vector<std::string>>{
           {}, {"--causal"}, {"--lag", "0.5"}, {"--estimator", "thesis"}}) {
    std::vector<std::string> arguments = {"orient", session(), "-o", path("orientation.csv")};
    arguments.insert(arguments.end(), how.begin(), how.end());
    const auto run = gimbalctl(arguments);
    EXPECT_EQ(run.exit_status, 0) << run.standard_error;
    EXPECT_EQ(lines_of(path("orientation.csv")).size(), gyro);
  }
}

}  // namespace
}  // namespace gimbal
