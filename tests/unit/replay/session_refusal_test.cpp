// Sessions that cannot be used, and what is said of them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "drivers/replay/session.hpp"
#include "tests/unit/replay/session_faults.hpp"

namespace gimbal::session_faults {
namespace {

using test::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::Not;

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

TEST(UnusablePath, OnlyRegularFilesAreRead) {
  const TemporaryFolder folder;
  for (const auto& [name, content] : good_session()) folder.write(name, content);
  std::filesystem::remove(folder.path() / "gyro.csv");
  std::filesystem::create_symlink("/dev/zero", folder.path() / "gyro.csv");
  const Result<Session> session = open_session(folder.path());
  ASSERT_FALSE(session);
  EXPECT_THAT(session.error().message, HasSubstr("gyro.csv: not a regular file"));
}

TEST(UnusablePath, APathThatIsNoSessionSaysSo) {
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
}  // namespace gimbal::session_faults
