// Sessions that can be used, though something about them is odd.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "drivers/replay/session.hpp"
#include "tests/unit/replay/session_faults.hpp"

namespace gimbal::session_faults {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

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
        Fault{"readout_longer_than_a_frame",
              in_toml("readout_s = 0.03", "readout_s = 8.0"),
              {"camera.readout_s is 8, longer than a frame"}},
        Fault{"K_for_a_larger_picture",
              in_toml("[500.0, 0, 320], [0, 500, 240]", "[1500.0, 0, 960], [0, 1500, 540]"),
              {"camera.K has its centre at (960, 540), outside the 640x480 picture"}},
        Fault{"last_line_cut_after_a_comma",
              [](Files& files) { files["gyro.csv"] += "2.0,0.1,0.2,"; },
              {"gyro.csv: the last line is cut off"}},
        Fault{"last_line_cut",
              [](Files& files) { files["gyro.csv"] += "2.0,0.1,-"; },
              {"gyro.csv: the last line is cut off"}},
        Fault{"last_line_without_columns",
              [](Files& files) { files["gyro.csv"] += "2.0,0.1"; },
              {"gyro.csv: the last line is cut off"}}),
    name_of);

}  // namespace
}  // namespace gimbal::session_faults
