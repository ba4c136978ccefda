// What a user may hand over by mistake. Each case spoils one thing of a good recording and runs the
// program on it: it must refuse with one line and status 2, or finish with a warning and write a
// video, whichever of the two is said here. It must never crash or hang.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <string_view>

#include "drivers/replay/video_probe.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

namespace fs = std::filesystem;
using test::ProgramRun;
using test::TemporaryFolder;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr int kLimit_s = 60;  // with sanitizers everything takes a while

ProgramRun gimbalctl(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), GIMBALCTL);
  return test::run_program(arguments, kLimit_s);
}

/// A short recording, made once for all cases.
const fs::path& good_session() {
  static const TemporaryFolder folder;
  static const fs::path session = [] {
    fs::path path = folder.path() / "good";
    const ProgramRun run = gimbalctl({"simulate", "-o", path.string(), "--size", "320x240",
                                      "--duration", "1.2", "--motion", "walk"});
    EXPECT_EQ(run.exit_status, 0) << run.standard_error;
    return path;
  }();
  return session;
}

/// To be changed, or written to: a run lists its video in the session.
fs::path copy_of_good_session(const TemporaryFolder& folder) {
  fs::path copy = folder.path() / "session";
  fs::copy(good_session(), copy, fs::copy_options::recursive);
  return copy;
}

std::string content_of(const fs::path& file) {
  std::ostringstream content;
  content << std::ifstream(file, std::ios::binary).rdbuf();
  return content.str();
}

void write(const fs::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary) << content;
}

fs::path video_of(const fs::path& session) {
  for (const char* name : {"video.mkv", "video.mp4", "video.mov"}) {
    if (fs::exists(session / name)) return session / name;
  }
  return {};
}

/// Replaces the whole line that starts with `key`.
void set_line(const fs::path& file, const std::string& key, const std::string& line) {
  std::istringstream lines(content_of(file));
  std::string content;
  bool found = false;
  for (std::string old; std::getline(lines, old);) {
    const bool here = old.starts_with(key);
    found = found || here;
    content += (here ? line : old) + "\n";
  }
  ASSERT_TRUE(found) << key << " is not in " << file;
  write(file, content);
}

/// Applies `change` to the time stamp of every data row of a log whose stamps stand in `column`.
void change_times(const fs::path& file, int column, const std::function<double(double)>& change) {
  std::istringstream lines(content_of(file));
  std::ostringstream content;
  content.precision(12);
  std::string line;
  std::getline(lines, line);
  content << line << "\n";
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    std::string field;
    for (int i = 0; std::getline(fields, field, ','); ++i) {
      if (i > 0) content << ",";
      if (i == column) {
        content << change(std::stod(field));
      } else {
        content << field;
      }
    }
    content << "\n";
  }
  write(file, content.str());
}

void keep_lines(const fs::path& file, std::size_t count) {
  std::istringstream lines(content_of(file));
  std::string content;
  std::string line;
  for (std::size_t i = 0; i < count && std::getline(lines, line); ++i) content += line + "\n";
  write(file, content);
}

enum class Outcome {
  refused,          ///< status 2 and one line
  finished_warned,  ///< status 0, a warning, a video
};

struct Case {
  std::string name;
  Outcome outcome;
  std::string said;  ///< in the error, or in one of the warnings
  std::function<void(const fs::path& session)> spoil;
};

void PrintTo(const Case& c, std::ostream* stream) {
  *stream << c.name;
}

std::vector<Case> cases() {
  const auto gyro = [](const fs::path& s) { return s / "gyro.csv"; };
  const auto accel = [](const fs::path& s) { return s / "accel.csv"; };
  const auto frames = [](const fs::path& s) { return s / "frames.csv"; };
  const auto toml = [](const fs::path& s) { return s / "session.toml"; };
  return {
      {"video_cut_in_half", Outcome::finished_warned,
       "video.mkv: holds no picture for the last 19 stamps of the frame list: is it cut short?",
       [](const fs::path& s) { fs::resize_file(video_of(s), fs::file_size(video_of(s)) / 2); }},
      {"video_empty", Outcome::refused, "video.mkv: no picture can be decoded from it",
       [](const fs::path& s) { write(video_of(s), ""); }},
      {"video_is_text", Outcome::refused, "video.mkv: no picture can be decoded from it",
       [](const fs::path& s) { write(video_of(s), "this is not a video\n"); }},
      {"video_is_a_folder", Outcome::refused, "video.mkv: no such video file",
       [](const fs::path& s) {
         const fs::path video = video_of(s);
         fs::remove(video);
         fs::create_directory(video);
       }},
      {"video_missing", Outcome::refused,
       "no video in this session: video.mkv, video.mp4 or video.mov is expected",
       [](const fs::path& s) { fs::remove(video_of(s)); }},
      {"gyro_empty_file", Outcome::refused,
       "gyro.csv: empty; a header line t_s,x,y,z and rows are expected",
       [=](const fs::path& s) { write(gyro(s), ""); }},
      {"gyro_header_only", Outcome::refused,
       "gyro.csv: no rows after the header; leave the file out if there are none",
       [=](const fs::path& s) { keep_lines(gyro(s), 1); }},
      {"gyro_one_sample", Outcome::refused,
       "gyro.csv: only one usable sample, at least two are needed",
       [=](const fs::path& s) { keep_lines(gyro(s), 2); }},
      {"gyro_missing", Outcome::finished_warned, "no gyro.csv: only plain pass-through is possible",
       [=](const fs::path& s) { fs::remove(gyro(s)); }},
      {"gyro_all_nan", Outcome::refused,
       "gyro.csv: all 3 rows have values that are not finite; numbers are expected",
       [=](const fs::path& s) {
         write(gyro(s), "t_s,x,y,z\n0.0,nan,nan,nan\n0.01,nan,nan,nan\n0.02,nan,nan,nan\n");
       }},
      {"gyro_text_in_numbers", Outcome::refused,
       "gyro.csv, line 322, column t_s: found \"a\", a time is expected",
       [=](const fs::path& s) { write(gyro(s), content_of(gyro(s)) + "a,b,c,d\n"); }},
      {"gyro_row_cut", Outcome::finished_warned, "gyro.csv: the last line is cut off and left out",
       [=](const fs::path& s) { write(gyro(s), content_of(gyro(s)) + "9.9,0.1"); }},
      {"gyro_binary", Outcome::refused, "gyro.csv, line 1: longer than",
       [=](const fs::path& s) { write(gyro(s), std::string(4096, '\x01')); }},
      {"gyro_times_in_ms", Outcome::refused,
       "gyro.csv: t_s must be in seconds, but its steps of 5 look like milliseconds",
       [=](const fs::path& s) { change_times(gyro(s), 0, [](double t) { return t * 1e3; }); }},
      {"gyro_times_in_ns", Outcome::refused,
       "gyro.csv: t_s must be in seconds, but its steps of 5e+06 look like nanoseconds",
       [=](const fs::path& s) { change_times(gyro(s), 0, [](double t) { return t * 1e9; }); }},
      {"gyro_elsewhere_in_time", Outcome::refused,
       "have no time in common; are both on one clock, and is camera.time_offset_s right?",
       [=](const fs::path& s) { change_times(gyro(s), 0, [](double t) { return t + 1000; }); }},
      {"gyro_ends_early", Outcome::finished_warned,
       "33 of 36 frames were taken while there was no gyro",
       [=](const fs::path& s) { keep_lines(gyro(s), 60); }},
      {"accel_empty_file", Outcome::finished_warned,
       "accel.csv: no usable sample; taken as if there were no accelerometer",
       [=](const fs::path& s) { write(accel(s), ""); }},
      {"accel_all_nan", Outcome::finished_warned,
       "accel.csv: no usable sample; taken as if there were no accelerometer",
       [=](const fs::path& s) { write(accel(s), "t_s,x,y,z\n0.0,nan,nan,nan\n"); }},
      {"frames_missing", Outcome::refused, "frames.csv: no such file",
       [=](const fs::path& s) { fs::remove(frames(s)); }},
      {"frames_empty", Outcome::refused,
       "frames.csv: empty; a header line index,t_s and rows are expected",
       [=](const fs::path& s) { write(frames(s), ""); }},
      {"frames_shorter_than_video", Outcome::finished_warned,
       "video.mkv: 17 pictures have no stamp in the frame list and are left out",
       [=](const fs::path& s) { keep_lines(frames(s), 20); }},
      {"frames_longer_than_video", Outcome::finished_warned,
       "video.mkv: holds no picture for the last 2 stamps of the frame list",
       [=](const fs::path& s) { write(frames(s), content_of(frames(s)) + "36,2.24\n37,2.28\n"); }},
      {"frames_times_in_us", Outcome::refused,
       "frames.csv: t_s must be in seconds, but its steps of 33333.3 look like microseconds",
       [=](const fs::path& s) { change_times(frames(s), 1, [](double t) { return t * 1e6; }); }},
      {"toml_missing", Outcome::refused,
       "no session.toml in it; if it is a recording of another kind, gimbalctl sessions import",
       [=](const fs::path& s) { fs::remove(toml(s)); }},
      {"toml_not_utf8", Outcome::refused, "session.toml, line 24: ",
       [=](const fs::path& s) { write(toml(s), content_of(toml(s)) + "x = \"\xff\xfe\"\n"); }},
      {"toml_not_toml", Outcome::refused, "session.toml, line 1: ",
       [=](const fs::path& s) { write(toml(s), "[camera\nwidth 320\n"); }},
      {"toml_width_is_text", Outcome::refused,
       "session.toml, line 9: camera.width is \"wide\"; a whole number from 1 to 65535 is",
       [=](const fs::path& s) { set_line(toml(s), "width", "width = \"wide\""); }},
      {"toml_width_differs_from_video", Outcome::refused,
       "frames are 320x240, session.toml says 322x240 under [camera]",
       [=](const fs::path& s) { set_line(toml(s), "width", "width = 322"); }},
      {"toml_focal_length_zero", Outcome::refused,
       "session.toml, line 13: camera.K or distortion cannot be used",
       [=](const fs::path& s) {
         set_line(toml(s), "K", "K = [[0.0, 0.0, 160.0], [0.0, 300.0, 120.0], [0.0, 0.0, 1.0]]");
       }},
      {"toml_readout_negative", Outcome::refused,
       "session.toml, line 15: camera.readout_s is -0.01; 0 to 10 seconds are allowed",
       [=](const fs::path& s) { set_line(toml(s), "readout_s", "readout_s = -0.01"); }},
      {"toml_readout_nan", Outcome::refused,
       "session.toml, line 15: camera.readout_s is \"nan\"; a finite number is expected",
       [=](const fs::path& s) { set_line(toml(s), "readout_s", "readout_s = nan"); }},
      {"toml_direction_unknown", Outcome::refused,
       "session.toml, line 16: camera.readout_direction is \"sideways\"; allowed are",
       [=](const fs::path& s) {
         set_line(toml(s), "readout_direction", "readout_direction = \"sideways\"");
       }},
  };
}

class BadInput : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    const fs::path session = copy_of_good_session(folder_);
    GetParam().spoil(session);
    run_ = gimbalctl({"stabilize", session.string(), "-o", out_.string(), "--warper", "cpu"});
  }

  void expect_refused() const {
    EXPECT_EQ(run_.exit_status, 2) << run_.standard_error;
    const auto warnings = test::lines_starting_with(run_.standard_error, "gimbalctl: warning: ");
    const auto lines = test::lines_starting_with(run_.standard_error, "");
    ASSERT_EQ(lines.size(), warnings.size() + 1) << run_.standard_error;
    EXPECT_TRUE(lines.back().starts_with("gimbalctl: "));
    EXPECT_THAT(lines.back(), HasSubstr(GetParam().said));
    EXPECT_FALSE(fs::exists(out_));
  }

  void expect_finished_warned() const {
    ASSERT_EQ(run_.exit_status, 0) << run_.standard_error;
    EXPECT_THAT(test::lines_starting_with(run_.standard_error, "gimbalctl: warning: "),
                Contains(HasSubstr(GetParam().said)));
    const auto written = probe_video(out_);
    ASSERT_TRUE(written) << written.error().message;
    EXPECT_EQ(written->size, (ImageSize{320, 240}));
  }

  TemporaryFolder folder_;
  fs::path out_ = folder_.path() / "out.mkv";
  ProgramRun run_;
};

TEST_P(BadInput, IsRefusedInOneLineOrFinishedWithAWarning) {
  EXPECT_EQ(run_.standard_output, "");
  if (GetParam().outcome == Outcome::refused) {
    expect_refused();
  } else {
    expect_finished_warned();
  }
}

INSTANTIATE_TEST_SUITE_P(Stabilize, BadInput, ::testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

TEST(GoodInput, IsWrittenWithoutAWarning) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out.mkv";
  const ProgramRun run = gimbalctl(
      {"stabilize", copy_of_good_session(folder).string(), "-o", out.string(), "--warper", "cpu"});
  EXPECT_EQ(run.exit_status, 0);
  EXPECT_EQ(run.standard_error, "");
  EXPECT_TRUE(fs::exists(out));
}

struct Usage {
  std::string name;
  std::vector<std::string> arguments;
};

void PrintTo(const Usage& u, std::ostream* stream) {
  *stream << u.name;
}

class BadUsage : public ::testing::TestWithParam<Usage> {};

TEST_P(BadUsage, IsRefusedInOneLine) {
  std::vector<std::string> arguments = GetParam().arguments;
  for (std::string& argument : arguments) {
    constexpr std::string_view kSession = "SESSION";
    if (!argument.starts_with(kSession)) continue;
    argument.replace(0, kSession.size(), good_session().string());
  }
  const ProgramRun run = gimbalctl(arguments);
  EXPECT_EQ(run.exit_status, 2) << run.standard_error;
  EXPECT_EQ(test::lines_starting_with(run.standard_error, "gimbalctl: ").size(), 1U)
      << run.standard_error;
  for (const char letter : run.standard_error) {
    EXPECT_TRUE(static_cast<unsigned char>(letter) >= ' ' || letter == '\n') << run.standard_error;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Commands, BadUsage,
    ::testing::Values(
        Usage{"nothing", {}}, Usage{"unknown_command", {"stabilise"}},
        Usage{"no_session", {"stabilize", "/nonexistent", "-o", "/tmp/x.mp4"}},
        Usage{"no_output", {"stabilize", "SESSION"}},
        Usage{"unknown_ending", {"stabilize", "SESSION", "-o", "/tmp/out.docx"}},
        Usage{"folder_of_output_missing", {"stabilize", "SESSION", "-o", "/nonexistent/out.mp4"}},
        Usage{"report_is_the_output",
              {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--report", "/tmp/../tmp/x.mp4"}},
        Usage{"path_log_is_the_recordings",
              {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--path-log", "SESSION/frames.csv"}},
        Usage{"odd_size", {"simulate", "-o", "/tmp/x-session", "--size", "321x241"}},
        Usage{"bad_pipeline", {"stabilize", "SESSION", "-o", "nosuchelement ! fakesink"}},
        Usage{"amount_too_large", {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--amount", "2"}},
        Usage{"amount_is_text", {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--amount", "much"}},
        Usage{"amount_is_nan", {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--amount", "nan"}},
        Usage{"latency_negative", {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--latency", "-1"}},
        Usage{"zoom_below_one", {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--zoom", "0.5"}},
        Usage{"zoom_limits_swapped",
              {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--zoom-limits", "1.4..1.0"}},
        Usage{"zoom_limits_below_one",
              {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--zoom-limits", "0.9..1.2"}},
        Usage{"zoom_limit_alone",
              {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--zoom-limits", "1.2"}},
        Usage{"zoom_limits_of_a_fixed_zoom",
              {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--zoom", "1.1", "--zoom-limits",
               "1..1.2"}},
        Usage{"zoom_limits_without_crop",
              {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--border", "fill", "--zoom-limits",
               "1..1.2"}},
        Usage{"zoom_speed_zero", {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--zoom-speed", "0"}},
        Usage{
            "zoom_speed_of_a_low_pass",
            {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--zoom-speed", "0.1", "--path", "hann"}},
        Usage{"border_unknown", {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--border", "blue"}},
        Usage{"border_is_a_number", {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--border", "3"}},
        Usage{"estimator_unknown", {"orient", "SESSION", "-o", "-", "--estimator", "vqf"}},
        Usage{"reference_row_outside",
              {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--reference-row", "1e9"}},
        Usage{"reference_row_nan",
              {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--reference-row", "nan"}},
        Usage{"lag_negative", {"orient", "SESSION", "-o", "-", "--lag", "-1"}},
        Usage{"noise_is_nan", {"simulate", "-o", "/tmp/nowhere", "--gyro-noise", "nan"}},
        Usage{"offset_beyond_time", {"simulate", "-o", "/tmp/nowhere", "--time-offset", "1e300"}},
        Usage{"orient_no_session", {"orient", "/nonexistent", "-o", "/tmp/x.csv"}},
        Usage{"report_unwritable",
              {"stabilize", "SESSION", "-o", "fakesink ! fakesink", "--report", "/nonexistent/r"}}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace gimbal
