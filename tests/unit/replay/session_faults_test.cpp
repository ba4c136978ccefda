#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "drivers/replay/session.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using test::TemporaryFolder;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using Files = std::map<std::string, std::string>;

std::string gyro_csv(int first, int count, double factor = 1.0) {
  std::string text = "t_s,x,y,z\n";
  for (int i = first; i < first + count; ++i) {
    text += fmt::format("{},0.25,-0.5,{}\n", i * 0.01 * factor, i * 0.001);
  }
  return text;
}

std::string accel_csv(int first, int count) {
  std::string text = "t_s,x,y,z\n";
  for (int i = first; i < first + count; ++i) text += fmt::format("{},0,9.81,0\n", i * 0.01);
  return text;
}

std::string frames_csv(int count, double factor = 1.0) {
  std::string text = "index,t_s\n";
  for (int i = 0; i < count; ++i) text += fmt::format("{},{}\n", i, (0.5 + i / 30.0) * factor);
  return text;
}

/// Two seconds at 100 Hz, with thirty frames in the middle; nothing is odd about it.
Files good_session() {
  return {{"session.toml",
           "device = \"phone\"\n"
           "recorded_at = \"2021-07-29T03:52:25Z\"\n"
           "[camera]\n"
           "width = 640\n"
           "height = 480\n"
           "fps = 30.0\n"
           "K = [[500.0, 0, 320], [0, 500, 240], [0, 0, 1]]\n"
           "readout_s = 0.03\n"
           "[imu]\n"
           "R_camera_imu = [[0, -1, 0], [-1, 0, 0], [0, 0, -1]]\n"},
          {"gyro.csv", gyro_csv(0, 200)},
          {"accel.csv", accel_csv(0, 200)},
          {"frames.csv", frames_csv(30)},
          {"video.mkv", "not looked at here"}};
}

Result<Session> open(const Files& files) {
  const TemporaryFolder folder;
  for (const auto& [name, content] : files) folder.write(name, content);
  return open_session(folder.path());
}

void replace(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
}

TEST(SessionFaults, AGoodSessionHasNone) {
  const Result<Session> session = open(good_session());
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_THAT(session->warnings, IsEmpty());
  EXPECT_EQ(session->gyro.size(), 200U);
  EXPECT_EQ(session->accel.size(), 200U);
  EXPECT_EQ(session->frames.size(), 30U);
}

struct Fault {
  std::string name;
  std::function<void(Files&)> spoil;
  std::vector<std::string> said;  ///< in the error, or in one of the warnings
};

void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.name;
}

void toml(Files& files, const std::string& from, const std::string& to) {
  replace(files["session.toml"], from, to);
}

/// Spoils the session.toml at one place.
std::function<void(Files&)> in_toml(const std::string& from, const std::string& to) {
  return [=](Files& files) { toml(files, from, to); };
}

std::function<void(Files&)> in_file(const std::string& name, const std::string& from,
                                    const std::string& to) {
  return [=](Files& files) { replace(files[name], from, to); };
}

std::function<void(Files&)> instead(const std::string& name, const std::string& content) {
  return [=](Files& files) { files[name] = content; };
}

std::string name_of(const ::testing::TestParamInfo<Fault>& parameter) {
  return parameter.param.name;
}

class UnusableSession : public ::testing::TestWithParam<Fault> {};

TEST_P(UnusableSession, IsRefusedInOneLineThatSaysWhy) {
  Files files = good_session();
  GetParam().spoil(files);
  const Result<Session> session = open(files);
  ASSERT_FALSE(session);
  EXPECT_EQ(session.error().kind, Error::Kind::bad_input);
  EXPECT_THAT(session.error().message, Not(HasSubstr("\n")));
  for (const std::string& words : GetParam().said) {
    EXPECT_THAT(session.error().message, HasSubstr(words));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Faults, UnusableSession,
    ::testing::Values(
        Fault{"no_toml",
              [](Files& files) { files.erase("session.toml"); },
              {"no session.toml", "gimbalctl sessions import"}},
        Fault{"no_frames",
              [](Files& files) { files.erase("frames.csv"); },
              {"frames.csv: no such file"}},
        Fault{"empty_gyro", instead("gyro.csv", ""), {"gyro.csv: empty", "t_s,x,y,z"}},
        Fault{"blank_gyro", instead("gyro.csv", "\n\n  \n"), {"gyro.csv: empty"}},
        Fault{"gyro_is_only_a_header",
              instead("gyro.csv", "t_s,x,y,z\n"),
              {"gyro.csv: no rows after the header"}},
        Fault{"frames_is_only_a_header",
              instead("frames.csv", "index,t_s"),
              {"frames.csv: no rows after the header"}},
        Fault{"gyro_has_one_row",
              instead("gyro.csv", "t_s,x,y,z\n1,2,3,4\n"),
              {"gyro.csv: only one usable sample"}},
        Fault{"gyro_without_header",
              instead("gyro.csv", "0.1,0,0,0\n0.2,0,0,0\n"),
              {"gyro.csv, line 1: no column t_s", "\"0.1,0,0,0\"", "t_s,x,y,z is expected"}},
        Fault{"all_nan",
              instead("gyro.csv", "t_s,x,y,z\n0,nan,0,0\n0.01,NaN,inf,0\n"),
              {"gyro.csv: all 2 rows", "not finite"}},
        Fault{"all_frame_times_nan",
              instead("frames.csv", "index,t_s\n0,nan\n1,nan\n"),
              {"frames.csv: all 2 rows", "not finite"}},
        Fault{"text_for_a_number",
              in_file("gyro.csv", "0.02,0.25,-0.5", "0.02,abc,-0.5"),
              {"gyro.csv, line 4, column x: found \"abc\"", "number is expected"}},
        Fault{"text_for_a_time",
              in_file("frames.csv", "1,0.53", "1,late0.53"),
              {"frames.csv, line 3, column t_s: found \"late0.53"}},
        Fault{"missing_column",
              in_file("gyro.csv", "0.02,0.25,-0.5,0.002", "0.02,0.25"),
              {"gyro.csv, line 4: column y is missing"}},
        Fault{"empty_field",
              in_file("gyro.csv", "0.02,0.25,", "0.02,,"),
              {"gyro.csv, line 4, column x: found \"\""}},
        Fault{"bytes_that_are_no_text",
              in_file("gyro.csv", "0.02,0.25", std::string("0.02,\x00\xff\x01", 8)),
              {"gyro.csv, line 4, column x: found \"\\x00\\xff\\x01\""}},
        Fault{"endless_line",
              instead("gyro.csv", std::string(100'000, 'x')),
              {"gyro.csv, line 1: longer than"}},
        Fault{"gyro_in_milliseconds",
              instead("gyro.csv", gyro_csv(0, 200, 1e3)),
              {"gyro.csv: t_s must be in seconds", "milliseconds"}},
        Fault{"gyro_in_microseconds",
              instead("gyro.csv", gyro_csv(0, 200, 1e6)),
              {"gyro.csv: t_s must be in seconds", "microseconds"}},
        Fault{"gyro_in_nanoseconds",
              instead("gyro.csv", gyro_csv(0, 200, 1e9)),
              {"gyro.csv: t_s must be in seconds", "nanoseconds"}},
        Fault{"gyro_in_nanoseconds_since_1970",
              instead("gyro.csv",
                      "t_s,x,y,z\n1627530745150090000,0,0,0\n1627530745160090000,0,0,0\n"),
              {"gyro.csv, line 2, column t_s", "nanoseconds"}},
        Fault{"frames_in_milliseconds",
              instead("frames.csv", frames_csv(30, 1e3)),
              {"frames.csv: t_s must be in seconds", "milliseconds"}},
        Fault{"frames_in_microseconds",
              instead("frames.csv", frames_csv(30, 1e6)),
              {"frames.csv: t_s must be in seconds", "microseconds"}},
        Fault{"another_clock",
              instead("gyro.csv", gyro_csv(1000, 200)),
              {"no time in common", "gyro (10.000 to 11.990 s)", "frames (0.500 to 1.497 s)",
               "time_offset_s"}},
        Fault{"offset_beyond_the_gyro",
              in_toml("readout_s", "time_offset_s = 100.0\nreadout_s"),
              {"no time in common", "frames (100.500 to 101.497 s)"}},
        Fault{"indices_fall",
              in_file("frames.csv", "\n5,", "\n3,"),
              {"frames.csv, line 7: index 3 does not rise"}},
        Fault{"negative_index",
              in_file("frames.csv", "\n0,", "\n-1,"),
              {"frames.csv, line 2: index -1"}},
        Fault{"fractional_index",
              in_file("frames.csv", "\n0,", "\n0.5,"),
              {"frames.csv, line 2, column index: found \"0.5\"", "whole number"}},
        Fault{"toml_is_not_utf8", in_toml("phone", "ph\xff\xfene"), {"session.toml, line 1"}},
        Fault{
            "toml_is_not_toml", in_toml("width = 640", "width = = 640"), {"session.toml, line 4"}},
        Fault{"toml_key_twice", in_toml("height = 480", "width = 480"), {"session.toml, line 5"}},
        Fault{"toml_nested_deeply",
              in_toml("\"phone\"", std::string(100'000, '[')),
              {"session.toml, line 1"}},
        Fault{"toml_is_huge",
              in_toml("phone", std::string(2'000'000, 'x')),
              {"session.toml: larger"}},
        Fault{"zero_focal_length",
              in_toml("[500.0, 0, 320]", "[0, 0, 320]"),
              {"session.toml, line 7: camera.K", "fx = 0"}},
        Fault{"negative_focal_length",
              in_toml("[0, 500, 240]", "[0, -500, 240]"),
              {"session.toml, line 7: camera.K", "fy = -500"}},
        Fault{"focal_length_nan",
              in_toml("[500.0, 0, 320]", "[nan, 0, 320]"),
              {"session.toml, line 7: camera.K", "finite"}},
        Fault{"K_is_infinite",
              in_toml("[500.0, 0, 320]", "[500.0, 0, inf]"),
              {"session.toml, line 7: camera.K", "finite"}},
        Fault{"K_has_two_rows",
              in_toml(", [0, 0, 1]]", "]"),
              {"session.toml, line 7: camera.K is", "three rows of three finite numbers"}},
        Fault{"K_is_text",
              in_toml("[[500.0, 0, 320], [0, 500, 240], [0, 0, 1]]", "\"500\""),
              {"camera.K is", "500", "three rows of three finite numbers"}},
        Fault{"K_transposed",
              in_toml("[500.0, 0, 320], [0, 500, 240], [0, 0, 1]",
                      "[500.0, 0, 0], [0, 500, 0], [320, 240, 1]"),
              {"session.toml, line 7: camera.K"}},
        Fault{"K_without_size",
              in_toml("width = 640\nheight = 480\n", ""),
              {"camera.K needs width and height"}},
        Fault{"unknown_model",
              in_toml("fps", "model = \"pinhol\"\nfps"),
              {"line 6: camera.model is \"pinhol\"", "\"pinhole\", \"brown\", \"fisheye\""}},
        Fault{"distortion_of_the_wrong_length",
              in_toml("fps", "model = \"fisheye\"\ndistortion = [0.1]\nfps"),
              {"camera.K or distortion", "fisheye"}},
        Fault{"width_is_text",
              in_toml("640", "\"640\""),
              {"line 4: camera.width is", "whole number"}},
        Fault{
            "width_is_zero", in_toml("640", "0"), {"line 4: camera.width is \"0\"", "1 to 65535"}},
        Fault{"width_is_absurd", in_toml("640", "1000000000000"), {"line 4: camera.width"}},
        Fault{"camera_is_a_number",
              in_toml("[camera]", "camera = 5\n[other]"),
              {"line 3: camera is \"5\"", "[camera]"}},
        Fault{"device_is_a_number", in_toml("\"phone\"", "7"), {"line 1: device is \"7\"", "text"}},
        Fault{"negative_readout", in_toml("0.03", "-0.03"), {"line 8: camera.readout_s is -0.03"}},
        Fault{"readout_in_milliseconds",
              in_toml("0.03", "30"),
              {"camera.readout_s is 30", "seconds"}},
        Fault{"axes_are_a_mirror",
              in_toml("[0, 0, -1]]", "[0, 0, 1]]"),
              {"line 10: imu.R_camera_imu is a mirror"}},
        Fault{"axes_are_no_rotation",
              in_toml("[[0, -1, 0]", "[[0, -2, 0]"),
              {"line 10: imu.R_camera_imu is not a rotation"}},
        Fault{"unknown_accel_unit",
              in_toml("[imu]", "[imu]\naccel_unit = \"ft/s2\""),
              {"line 10: imu.accel_unit is \"ft/s2\"", "\"m/s2\", \"g\""}},
        Fault{"unknown_timestamp",
              in_toml("fps", "timestamp = \"start\"\nfps"),
              {"camera.timestamp is \"start\"", "readout-start"}}),
    name_of);

class OddSession : public ::testing::TestWithParam<Fault> {};

TEST_P(OddSession, OpensWithAWarningThatSaysWhatWasDone) {
  Files files = good_session();
  GetParam().spoil(files);
  const Result<Session> session = open(files);
  ASSERT_TRUE(session) << session.error().message;
  for (const std::string& words : GetParam().said) {
    EXPECT_THAT(session->warnings, Contains(HasSubstr(words)));
  }
  for (const std::string& warning : session->warnings) EXPECT_THAT(warning, Not(HasSubstr("\n")));
  for (std::size_t i = 1; i < session->gyro.size(); ++i) {
    ASSERT_GT(session->gyro[i].time, session->gyro[i - 1].time);
  }
  for (const GyroSample& sample : session->gyro) ASSERT_TRUE(sample.gyro_rad_s.allFinite());
}

INSTANTIATE_TEST_SUITE_P(
    Faults, OddSession,
    ::testing::Values(
        Fault{"no_gyro",
              [](Files& files) { files.erase("gyro.csv"); },
              {"no gyro.csv: only plain pass-through"}},
        Fault{"no_video", [](Files& files) { files.erase("video.mkv"); }, {"no video.mkv"}},
        Fault{"two_videos", instead("video.mp4", "x"), {"video.mp4 is passed over"}},
        Fault{"accel_empty", instead("accel.csv", ""), {"accel.csv: no usable sample"}},
        Fault{"accel_is_only_a_header",
              instead("accel.csv", "t_s,x,y,z\n"),
              {"accel.csv: no usable sample"}},
        Fault{"accel_all_nan",
              instead("accel.csv", "t_s,x,y,z\n0,nan,0,0\n"),
              {"accel.csv: no usable sample", "accel.csv: 1 row left out"}},
        Fault{"accel_starts_late",
              instead("accel.csv", accel_csv(50, 150)),
              {"accelerometer starts 0.500 s after the gyro"}},
        Fault{"accel_ends_early",
              instead("accel.csv", accel_csv(0, 50)),
              {"accelerometer ends 1.500 s before the gyro"}},
        Fault{"accel_in_g",
              instead("accel.csv", "t_s,x,y,z\n0,0,1,0\n0.01,0,1,0\n0.02,0,1,0\n"),
              {"accel.csv: median acceleration is 1 m/s2"}},
        Fault{"gyro_starts_late",
              instead("gyro.csv", gyro_csv(60, 140)),
              {"gyro starts 0.100 s after the first frame", "3 of 30 frames"}},
        Fault{"gyro_ends_early", instead("gyro.csv", gyro_csv(0, 80)), {"gyro ends 0.7"}},
        Fault{"some_nan",
              in_file("gyro.csv", "0.02,0.25", "0.02,nan"),
              {"gyro.csv: 1 row left out with values that are not finite, first on line 4"}},
        Fault{"number_too_large",
              in_file("gyro.csv", "0.02,0.25", "0.02,1e999"),
              {"gyro.csv: 1 row left out with values that are not finite, first on line 4"}},
        Fault{"stamp_steps_back",
              in_file("gyro.csv", "\n0.5,", "\n0.485,"),
              {"gyro.csv: 1 row left out because stamps do not rise: line 52 steps back by 0.005"}},
        Fault{"stamp_repeats",
              in_file("gyro.csv", "\n0.5,", "\n0.49,"),
              {"gyro.csv: 1 row left out", "line 52 repeats a stamp"}},
        Fault{"stamp_leaps_ahead",
              in_file("gyro.csv", "\n0.5,", "\n99,"),
              {"gyro.csv: 1 row left out", "line 52 is not before line 53"}},
        Fault{"frame_stamp_steps_back",
              in_file("frames.csv", "\n6,0.7", "\n6,0.6"),
              {"frames.csv: 1 row left out"}},
        Fault{"gap_of_235_ms",
              [](Files& files) {
                files["gyro.csv"] = gyro_csv(0, 80);
                for (int i = 0; i < 100; ++i) {
                  files["gyro.csv"] += fmt::format("{},0,0,0\n", 0.79 + 0.235 + i * 0.01);
                }
              },
              {"gyro.csv: 1 gap, of 0.235 s after line 81 (t = 0.790 s)"}},
        Fault{"frame_dropped",
              in_file("frames.csv", "\n6,0.7\n", "\n"),
              {"frames.csv: 1 gap, of 0.067 s after line 7"}},
        Fault{"rates_in_degrees", in_file("gyro.csv", "0.25", "250"), {"deg/s"}},
        Fault{"unknown_key",
              in_toml("readout_s", "readout = 0.02\nreadout_s"),
              {"session.toml, line 8: camera.\"readout\" is not known",
               "is camera.readout_s meant?"}},
        Fault{"unknown_table", in_toml("[imu]", "[lens]\nx = 1\n[imu]"), {"\"lens\" is not known"}},
        Fault{"no_K",
              in_toml("K = [[500.0, 0, 320], [0, 500, 240], [0, 0, 1]]", ""),
              {"camera.K is not given"}},
        Fault{
            "no_readout", in_toml("readout_s = 0.03", ""), {"camera.readout_s is 0 or not given"}},
        Fault{"last_line_cut",
              [](Files& files) { files["gyro.csv"] += "2.0,0.1,-"; },
              {"gyro.csv: the last line is cut off"}},
        Fault{"last_line_without_columns",
              [](Files& files) { files["gyro.csv"] += "2.0,0.1"; },
              {"gyro.csv: the last line is cut off"}}),
    name_of);

class Spelling : public ::testing::TestWithParam<Fault> {};

TEST_P(Spelling, IsNoFault) {
  Files files = good_session();
  GetParam().spoil(files);
  const Result<Session> session = open(files);
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_THAT(session->warnings, IsEmpty());
  const Result<Session> plain = open(good_session());
  ASSERT_EQ(session->gyro.size(), plain->gyro.size());
  for (std::size_t i = 0; i < plain->gyro.size(); ++i) {
    ASSERT_EQ(session->gyro[i].time, plain->gyro[i].time);
    ASSERT_EQ(session->gyro[i].gyro_rad_s, plain->gyro[i].gyro_rad_s);
  }
}

void with_line_ends(Files& files, const std::string& line_end) {
  for (const char* name : {"gyro.csv", "session.toml", "frames.csv"}) {
    std::string text;
    for (const char c : files[name]) text += c == '\n' ? line_end : std::string(1, c);
    files[name] = text;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Ways, Spelling,
    ::testing::Values(
        Fault{"crlf", [](Files& files) { with_line_ends(files, "\r\n"); }, {}},
        Fault{"byte_order_mark",
              [](Files& files) {
                files["gyro.csv"].insert(0, "\xef\xbb\xbf");
                files["session.toml"].insert(0, "\xef\xbb\xbf");
              },
              {}},
        Fault{"no_last_line_end", [](Files& files) { files["gyro.csv"].pop_back(); }, {}},
        Fault{"comments", [](Files& files) { files["gyro.csv"].insert(0, "# a\n#b,c\n"); }, {}},
        Fault{"comment_inside", in_file("gyro.csv", "\n0.5,", "\n# here\n\n0.5,"), {}},
        Fault{"spaces", in_file("gyro.csv", "0.02,0.25,-0.5", " 0.02 ,\t0.25, -0.5"), {}},
        Fault{"plus_signs", in_file("gyro.csv", "0.02,0.25", "+0.02,+0.25"), {}},
        Fault{"exponents", in_file("gyro.csv", "0.02,0.25", "2e-2,2.5E-1"), {}},
        Fault{"more_columns",
              [](Files& files) {
                with_line_ends(files, "\n"),
                    replace(files["gyro.csv"], "x,y,z", "x,y,z,temperature");
              },
              {}},
        Fault{"toml_date", in_toml("\"2021-07-29T03:52:25Z\"", "2021-07-29T03:52:25Z"), {}},
        Fault{"rounded_axes", in_toml("[[0, -1, 0]", "[[0.00001, -0.99999, 0]"), {}}),
    name_of);

TEST(SessionFaults, AccelerationComesInSpecificForceWhateverTheFileHas) {
  for (const auto& [unit, sign, factor] :
       {std::tuple("m/s2", "specific-force", 1.0), std::tuple("g", "specific-force", 9.80665),
        std::tuple("m/s2", "core-motion", -1.0), std::tuple("g", "core-motion", -9.80665)}) {
    Files files = good_session();
    files["accel.csv"] = "t_s,x,y,z\n0,0.5,-1,0.25\n0.01,1,1,1\n";
    toml(files, "[imu]",
         fmt::format("[imu]\naccel_unit = \"{}\"\naccel_sign = \"{}\"", unit, sign));
    const Result<Session> session = open(files);
    ASSERT_TRUE(session) << session.error().message;
    EXPECT_TRUE(session->accel[0].accel_m_s2.isApprox(factor * Eigen::Vector3d(0.5, -1, 0.25)))
        << unit << " " << sign;
  }
}

TEST(SessionFaults, AFrameStampThatIsLeftOutLeavesTheOthersTheirPictures) {
  Files files = good_session();
  replace(files["frames.csv"], "\n1,", "\n1,nan\n2,0.55\n99,");
  replace(files["frames.csv"], files["frames.csv"].substr(files["frames.csv"].find("\n99,")),
          "\n3,0.6");
  const Result<Session> session = open(files);
  ASSERT_TRUE(session) << session.error().message;
  std::vector<std::int64_t> indices;
  for (const FrameStamp& stamp : session->frames) indices.push_back(stamp.index);
  EXPECT_THAT(indices, ElementsAre(0, 2, 3));
}

TEST(SessionFaults, ExposuresThatSayNothingAreUnknown) {
  Files files = good_session();
  files["frames.csv"] = "index,t_s,exposure_s\n0,0.5,0.01\n1,0.53,\n2,0.56,nan\n3,0.6,-1\n4,0.63\n";
  const Result<Session> session = open(files);
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_EQ(session->frames.size(), 5U);
  EXPECT_EQ(session->frames[0].exposure, SensorDuration(10'000'000));
  for (std::size_t i = 1; i < 5; ++i) EXPECT_FALSE(session->frames[i].exposure) << i;
}

TEST(SessionFaults, EpochTimesKeepTheirMicroseconds) {
  Files files = good_session();
  files.erase("frames.csv");
  files.erase("video.mkv");
  files["gyro.csv"] = "t_s,x,y,z\n1627530745.150090,0,0,0\n1627530745.160091,0,0,0\n";
  const Result<Session> session = open(files);
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->gyro[1].time.time_since_epoch().count(), 1'627'530'745'160'091'000);
}

TEST(SessionFaults, OnlyRegularFilesAreRead) {
  const TemporaryFolder folder;
  for (const auto& [name, content] : good_session()) folder.write(name, content);
  std::filesystem::remove(folder.path() / "gyro.csv");
  std::filesystem::create_symlink("/dev/zero", folder.path() / "gyro.csv");
  const Result<Session> session = open_session(folder.path());
  ASSERT_FALSE(session);
  EXPECT_THAT(session.error().message, HasSubstr("gyro.csv: not a regular file"));
}

TEST(SessionFaults, APathThatIsNoSessionSaysSo) {
  const TemporaryFolder folder;
  folder.write("clip.mp4", "x");
  EXPECT_THAT(open_session(folder.path() / "nothing").error().message,
              HasSubstr("no such session"));
  EXPECT_THAT(open_session(folder.path() / "clip.mp4").error().message, HasSubstr(".gcsv"));
}

TEST(MakeSessionFolder, TakesOnlyNewOrEmptyOnes) {
  const TemporaryFolder folder;
  EXPECT_TRUE(make_session_folder(folder.path() / "a" / "b"));
  EXPECT_TRUE(make_session_folder(folder.path() / "a" / "b"));
  folder.write("full/file", "x");
  for (const char* name : {"full", "full/file", "full/file/deeper"}) {
    const Result<void> made = make_session_folder(folder.path() / name);
    ASSERT_FALSE(made) << name;
    EXPECT_EQ(made.error().kind, Error::Kind::bad_input);
  }
}

}  // namespace
}  // namespace gimbal
