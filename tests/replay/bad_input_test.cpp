// What a user may hand over by mistake. Each case spoils one thing of a good recording and runs the
// program on it: it must refuse with one line and status 2, or finish with a warning and write a
// video. It must never crash or hang.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include "drivers/replay/video_probe.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

namespace fs = std::filesystem;
using test::ProgramRun;
using test::TemporaryFolder;

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
  either,           ///< one of the two
};

struct Case {
  std::string name;
  Outcome outcome;
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
      {"video_cut_in_half", Outcome::either,
       [](const fs::path& s) { fs::resize_file(video_of(s), fs::file_size(video_of(s)) / 2); }},
      {"video_empty", Outcome::refused, [](const fs::path& s) { write(video_of(s), ""); }},
      {"video_is_text", Outcome::refused,
       [](const fs::path& s) { write(video_of(s), "this is not a video\n"); }},
      {"video_is_a_folder", Outcome::refused,
       [](const fs::path& s) {
         const fs::path video = video_of(s);
         fs::remove(video);
         fs::create_directory(video);
       }},
      {"video_missing", Outcome::refused, [](const fs::path& s) { fs::remove(video_of(s)); }},
      {"gyro_empty_file", Outcome::either, [=](const fs::path& s) { write(gyro(s), ""); }},
      {"gyro_header_only", Outcome::either, [=](const fs::path& s) { keep_lines(gyro(s), 1); }},
      {"gyro_one_sample", Outcome::either, [=](const fs::path& s) { keep_lines(gyro(s), 2); }},
      {"gyro_missing", Outcome::either, [=](const fs::path& s) { fs::remove(gyro(s)); }},
      {"gyro_all_nan", Outcome::either,
       [=](const fs::path& s) {
         write(gyro(s), "t_s,x,y,z\n0.0,nan,nan,nan\n0.01,nan,nan,nan\n0.02,nan,nan,nan\n");
       }},
      {"gyro_text_in_numbers", Outcome::either,
       [=](const fs::path& s) { write(gyro(s), content_of(gyro(s)) + "a,b,c,d\n"); }},
      {"gyro_row_cut", Outcome::either,
       [=](const fs::path& s) { write(gyro(s), content_of(gyro(s)) + "9.9,0.1"); }},
      {"gyro_binary", Outcome::refused,
       [=](const fs::path& s) { write(gyro(s), std::string(4096, '\x01')); }},
      {"gyro_times_in_ms", Outcome::either,
       [=](const fs::path& s) { change_times(gyro(s), 0, [](double t) { return t * 1e3; }); }},
      {"gyro_times_in_ns", Outcome::either,
       [=](const fs::path& s) { change_times(gyro(s), 0, [](double t) { return t * 1e9; }); }},
      {"gyro_elsewhere_in_time", Outcome::refused,
       [=](const fs::path& s) { change_times(gyro(s), 0, [](double t) { return t + 1000; }); }},
      {"gyro_ends_early", Outcome::finished_warned,
       [=](const fs::path& s) { keep_lines(gyro(s), 60); }},
      {"accel_empty_file", Outcome::either, [=](const fs::path& s) { write(accel(s), ""); }},
      {"accel_all_nan", Outcome::either,
       [=](const fs::path& s) { write(accel(s), "t_s,x,y,z\n0.0,nan,nan,nan\n"); }},
      {"frames_missing", Outcome::either, [=](const fs::path& s) { fs::remove(frames(s)); }},
      {"frames_empty", Outcome::refused, [=](const fs::path& s) { write(frames(s), ""); }},
      {"frames_shorter_than_video", Outcome::finished_warned,
       [=](const fs::path& s) { keep_lines(frames(s), 20); }},
      {"frames_longer_than_video", Outcome::finished_warned,
       [=](const fs::path& s) {
         write(frames(s), content_of(frames(s)) + "900,1.30\n901,1.34\n");
       }},
      {"frames_times_in_us", Outcome::either,
       [=](const fs::path& s) { change_times(frames(s), 1, [](double t) { return t * 1e6; }); }},
      {"toml_missing", Outcome::refused, [=](const fs::path& s) { fs::remove(toml(s)); }},
      {"toml_not_utf8", Outcome::refused,
       [=](const fs::path& s) { write(toml(s), content_of(toml(s)) + "x = \"\xff\xfe\"\n"); }},
      {"toml_not_toml", Outcome::refused,
       [=](const fs::path& s) { write(toml(s), "[camera\nwidth 320\n"); }},
      {"toml_width_is_text", Outcome::refused,
       [=](const fs::path& s) { set_line(toml(s), "width", "width = \"wide\""); }},
      {"toml_width_differs_from_video", Outcome::refused,
       [=](const fs::path& s) { set_line(toml(s), "width", "width = 322"); }},
      {"toml_focal_length_zero", Outcome::refused,
       [=](const fs::path& s) {
         set_line(toml(s), "K", "K = [[0.0, 0.0, 160.0], [0.0, 300.0, 120.0], [0.0, 0.0, 1.0]]");
       }},
      {"toml_readout_negative", Outcome::refused,
       [=](const fs::path& s) { set_line(toml(s), "readout_s", "readout_s = -0.01"); }},
      {"toml_readout_nan", Outcome::refused,
       [=](const fs::path& s) { set_line(toml(s), "readout_s", "readout_s = nan"); }},
      {"toml_direction_unknown", Outcome::refused,
       [=](const fs::path& s) {
         set_line(toml(s), "readout_direction", "readout_direction = \"sideways\"");
       }},
  };
}

class BadInput : public ::testing::TestWithParam<Case> {};

TEST_P(BadInput, IsRefusedInOneLineOrFinishedWithAWarning) {
  const TemporaryFolder folder;
  const fs::path session = folder.path() / "session";
  fs::copy(good_session(), session, fs::copy_options::recursive);
  GetParam().spoil(session);
  const fs::path out = folder.path() / "out.mkv";
  const ProgramRun run =
      gimbalctl({"stabilize", session.string(), "-o", out.string(), "--warper", "cpu"});

  const auto errors = test::lines_starting_with(run.standard_error, "gimbalctl: ");
  const auto warnings = test::lines_starting_with(run.standard_error, "gimbalctl: warning: ");
  EXPECT_EQ(run.standard_output, "");
  if (run.exit_status == 2) {
    EXPECT_NE(GetParam().outcome, Outcome::finished_warned) << run.standard_error;
    EXPECT_EQ(errors.size(), warnings.size() + 1) << run.standard_error;
    return;
  }
  ASSERT_EQ(run.exit_status, 0) << run.standard_error;
  EXPECT_NE(GetParam().outcome, Outcome::refused) << run.standard_error;
  EXPECT_GE(warnings.size(), 1U) << run.standard_error;
  const auto written = probe_video(out);
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(written->size, (ImageSize{320, 240}));
}

INSTANTIATE_TEST_SUITE_P(Stabilize, BadInput, ::testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

TEST(GoodInput, IsWrittenWithoutAWarning) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out.mkv";
  const ProgramRun run =
      gimbalctl({"stabilize", good_session().string(), "-o", out.string(), "--warper", "cpu"});
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
    if (argument == "SESSION") argument = good_session().string();
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
        Usage{"bad_pipeline", {"stabilize", "SESSION", "-o", "nosuchelement ! fakesink"}},
        Usage{"amount_too_large", {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--amount", "2"}},
        Usage{"amount_is_text", {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--amount", "much"}},
        Usage{"amount_is_nan", {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--amount", "nan"}},
        Usage{"latency_negative", {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--latency", "-1"}},
        Usage{"zoom_below_one", {"stabilize", "SESSION", "-o", "/tmp/x.mp4", "--zoom", "0.5"}},
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
