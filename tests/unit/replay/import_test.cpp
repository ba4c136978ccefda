#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "drivers/replay/import/importer.hpp"
#include "tests/support/gst_playback.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using test::TemporaryFolder;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::filesystem::path kRecordings = std::filesystem::path(GIMBALD_SHARED) / "data";

Eigen::Matrix3d R_landscape() {
  Eigen::Matrix3d R;
  R << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  return R;
}

void make_video(const std::filesystem::path& path, int count) {
  test::run_pipeline(
      fmt::format("videotestsrc num-buffers={} ! video/x-raw,width=64,height=48,framerate=30/1 "
                  "! x264enc tune=zerolatency ! {} ! filesink location={}",
                  count, path.extension() == ".mkv" ? "matroskamux" : "mp4mux", path.string()));
}

std::string read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(Import, PhoneRecordingWithFittedTimes) {
  const std::filesystem::path input = kRecordings / "sessions/phone-car";
  if (!std::filesystem::exists(input)) GTEST_SKIP() << "no recordings: set GIMBALD_SHARED_DIR";
  const TemporaryFolder folder;
  const Result<Session> session = import_session(input, folder.path() / "s");
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_THAT(session->warnings, IsEmpty());
  ASSERT_EQ(session->frames.size(), 101U);
  EXPECT_EQ(session->frames[100].time, SensorTime(SensorDuration(3'331'276'000)));
  EXPECT_FALSE(session->frames[0].exposure);
  ASSERT_EQ(session->gyro.size(), 2610U);
  EXPECT_EQ(session->gyro[0].time, SensorTime(SensorDuration(-1'499'814'000)));
  EXPECT_EQ(session->gyro[0].gyro_rad_s, Eigen::Vector3d(0.010081, -0.003201, 0.000729));
  EXPECT_EQ(session->imu.R_camera_imu, R_landscape());
  ASSERT_TRUE(session->camera);
  EXPECT_EQ(session->camera->size, (ImageSize{800, 600}));
  EXPECT_EQ(session->camera->lens.K(0, 0), 573.8534);
  EXPECT_EQ(session->camera->readout, SensorDuration(28'500'000));
  EXPECT_EQ(session->camera->time_offset, SensorDuration(-1'000'000));
  EXPECT_EQ(session->camera->timestamp, TimestampReference::readout_start);
  EXPECT_EQ(read(session->video), read(input / "video.mkv"));
  EXPECT_THAT(read(folder.path() / "s/session.toml"), HasSubstr("exposure of 0.0053 s"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "s/thumbnail.jpg"));
}

TEST(Import, PhoneLogWithArKitReference) {
  const std::filesystem::path input = kRecordings / "logs/iphone-handheld";
  if (!std::filesystem::exists(input)) GTEST_SKIP() << "no recordings: set GIMBALD_SHARED_DIR";
  const TemporaryFolder folder;
  const Result<Session> session = import_session(input, folder.path() / "s");
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->imu.R_camera_imu, R_landscape());
  ASSERT_EQ(session->accel.size(), 3210U);
  EXPECT_EQ(session->accel[0].accel_m_s2, Eigen::Vector3d(-0.075593, 7.270381, 6.160439));
  EXPECT_FALSE(session->camera);
  EXPECT_THAT(session->warnings, Contains(HasSubstr("gyro starts 0.038 s after the first frame")));
}

TEST(Import, OrientationTrialsOpenAsTheyAre) {
  const std::filesystem::path trials = kRecordings / "orientation";
  if (!std::filesystem::exists(trials)) GTEST_SKIP() << "no recordings: set GIMBALD_SHARED_DIR";
  const Result<Session> session = open_session(trials / "phone-Jakob_iPhone5_Dist_AR");
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_GT(session->gyro.size(), 10'000U);
  EXPECT_FALSE(session->camera);
}

/// As met in the wild: 100 Hz, the IMU ends 1.57 s before the last frame, one gyro stamp is 10 ms
/// back, one frame interval is 50 ms.
void write_ios_log(const TemporaryFolder& folder) {
  constexpr std::int64_t kStart_us = 1'627'530'745'040'137;
  const auto seconds = [](std::int64_t us) {
    return fmt::format("{}.{:06}", us / 1'000'000, us % 1'000'000);
  };
  std::string gyro;
  std::string accel;
  for (int i = 0; i < 150; ++i) {
    const std::int64_t t = kStart_us + 10'000 * (i == 70 ? 68 : i);
    gyro += fmt::format("{},0.068752,0.030092,-0.006554\n", seconds(t - 300));
    accel +=
        fmt::format("{},-0.954895,0.000977,-0.391464\n", seconds(kStart_us + 10'000 * i + 900));
  }
  std::string frames;
  for (int i = 0; i < 92; ++i) {
    const std::int64_t t = kStart_us + 33'333 * i + (i > 20 ? 16'667 : 0);
    frames += fmt::format("{},{},{},1461.888184,963.666687,694.755127\n", seconds(t), i,
                          i < 46 ? "1460.0" : "1461.888184");
  }
  folder.write("log/Gyro.txt", gyro);
  folder.write("log/Accel.txt", accel);
  folder.write("log/Frames.txt", frames);
  folder.write("log/Motion.txt", "1627530745.15,1,0,0,0\n");
}

TEST(Import, IosLoggerFolder) {
  const TemporaryFolder folder;
  write_ios_log(folder);
  make_video(folder.path() / "log/Frames.m4v", 92);
  const Result<Session> session = import_session(folder.path() / "log", folder.path() / "s");
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->frames.size(), 92U);
  EXPECT_EQ(session->frames[0].time, SensorTime(SensorDuration(1'627'530'745'040'137'000)));
  EXPECT_EQ(session->gyro.size(), 149U);
  ASSERT_EQ(session->accel.size(), 150U);
  EXPECT_TRUE(session->accel[0].accel_m_s2.isApprox(
      -9.80665 * Eigen::Vector3d(-0.954895, 0.000977, -0.391464)));
  EXPECT_EQ(session->imu.R_camera_imu, R_landscape());
  ASSERT_TRUE(session->camera);
  EXPECT_EQ(session->camera->size, (ImageSize{64, 48}));
  EXPECT_EQ(session->camera->lens.K(0, 0), 1461.888184);
  EXPECT_EQ(session->video.filename(), "video.mp4");
  EXPECT_THAT(session->warnings, Contains(HasSubstr("line 72 steps back by 0.010000 s")));
  EXPECT_THAT(session->warnings, Contains(HasSubstr("frames.csv: 1 gap, of 0.050 s")));
  EXPECT_THAT(session->warnings, Contains(HasSubstr("gyro ends 1.5")));
}

TEST(Import, CoreMotionLogInNanosecondsSinceBoot) {
  const TemporaryFolder folder;
  std::string gyro = "# Created by a logger\n";
  std::string accel = "# time x y z\n";
  for (int i = 0; i < 50; ++i) {
    gyro +=
        fmt::format("{} -0.007313 -0.002355 -0.001939\n", 436'000'653'291'125 + i * 10'000'000LL);
    accel += fmt::format("{} 0.01 -0.6 -0.8\n", 436'000'653'291'999 + i * 10'000'000LL);
  }
  folder.write("log/gyro.txt", gyro);
  folder.write("log/acce.txt", accel);
  const Result<Session> session = import_session(folder.path() / "log", folder.path() / "s");
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_EQ(session->gyro.size(), 50U);
  EXPECT_EQ(session->gyro[0].time, SensorTime(SensorDuration(436'000'653'291'125)));
  EXPECT_EQ(session->gyro[0].gyro_rad_s, Eigen::Vector3d(-0.007313, -0.002355, -0.001939));
  EXPECT_TRUE(session->accel[0].accel_m_s2.isApprox(9.80665 * Eigen::Vector3d(-0.01, 0.6, 0.8)));
}

TEST(Import, AndroidLogInOneFile) {
  const TemporaryFolder folder;
  std::string log;
  for (int i = 0; i < 50; ++i) {
    log += fmt::format("{} 0.1 0.2 0.3 0.5 9.7 1.0\n", 98'765'432'109'876 + i * 2'500'000LL);
  }
  folder.write("imu.txt", log);
  const Result<Session> session = import_session(folder.path() / "imu.txt", folder.path() / "s");
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_EQ(session->gyro.size(), 50U);
  EXPECT_EQ(session->gyro[49].time,
            SensorTime(SensorDuration(98'765'432'109'876 + 49 * 2'500'000LL)));
  EXPECT_EQ(session->gyro[0].gyro_rad_s, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(session->accel[0].accel_m_s2, Eigen::Vector3d(0.5, 9.7, 1.0));
}

/// One and a half seconds at 1 kHz.
std::string gyroflow_log(const std::string& more_header) {
  std::string log = "GYROFLOW IMU LOG\nversion,1.3\nid,potato_cam\n" + more_header +
                    "gscale,0.001\nascale,0.0005\nt,gx,gy,gz,ax,ay,az\n";
  for (int i = 0; i < 1500; ++i) log += fmt::format("{},100,200,300,400,1000,2000\n", i);
  return log;
}

TEST(Gyroflow, LogBesideAVideoOpensAsASession) {
  const TemporaryFolder folder;
  make_video(folder.path() / "clip.mp4", 30);
  folder.write("clip.gcsv", gyroflow_log("orientation,YxZ\nframe_readout_time,16\n"
                                         "frame_readout_direction,1\ntscale,0.001\n"));
  const Result<Session> session = open_session(folder.path() / "clip.mp4");
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->frames.size(), 30U);
  EXPECT_NEAR(seconds_since_epoch(session->frames[29].time), 29 / 30.0, 1e-6);
  ASSERT_EQ(session->gyro.size(), 1500U);
  EXPECT_EQ(session->gyro[1].time, SensorTime(SensorDuration(1'000'000)));
  // Gyroflow's x is the stored y, its y is minus the stored x.
  EXPECT_TRUE(session->gyro[0].gyro_rad_s.isApprox(Eigen::Vector3d(0.2, -0.1, 0.3)));
  EXPECT_TRUE(session->accel[0].accel_m_s2.isApprox(9.80665 * Eigen::Vector3d(0.5, -0.2, 1.0)));
  // Its x is up, its y left, its z back.
  EXPECT_EQ(session->imu.R_camera_imu * Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -1, 0));
  EXPECT_EQ(session->imu.R_camera_imu * Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(-1, 0, 0));
  EXPECT_EQ(session->imu.R_camera_imu * Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0, -1));
  ASSERT_TRUE(session->camera_without_lens);
  EXPECT_EQ(session->camera_without_lens->size, (ImageSize{64, 48}));
  EXPECT_EQ(session->camera_without_lens->readout, SensorDuration(16'000'000));
  EXPECT_EQ(session->camera_without_lens->readout_direction, ReadoutDirection::bottom_up);
  EXPECT_EQ(session->camera_without_lens->time_offset, SensorDuration(-8'000'000))
      << "its frame time is in the middle of the readout";
  EXPECT_THAT(session->warnings, Contains(HasSubstr("frame times are the video's own")));
}

TEST(Gyroflow, DefaultsAreTheFormats) {
  const TemporaryFolder folder;
  make_video(folder.path() / "clip.mkv", 30);
  folder.write("clip.gcsv", gyroflow_log(""));
  const Result<Session> session = import_session(folder.path() / "clip.mkv", folder.path() / "s");
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->gyro[1499].time, SensorTime(SensorDuration(1'499'000'000)));
  EXPECT_TRUE(session->gyro[0].gyro_rad_s.isApprox(Eigen::Vector3d(-0.1, -0.3, 0.2)));
  EXPECT_EQ(session->video.filename(), "video.mkv");
}

TEST(Gyroflow, ALensFromElsewhereCompletesIt) {
  const TemporaryFolder folder;
  make_video(folder.path() / "clip.mkv", 30);
  folder.write("clip.gcsv", gyroflow_log("frame_readout_time,16\n"));
  LensFile lens;
  lens.camera.size = {128, 96};  // twice the video's
  lens.camera.readout = SensorDuration(20'000'000);
  lens.camera.lens.K << 100, 0, 63.5, 0, 100, 47.5, 0, 0, 1;
  const auto session = import_session(folder.path() / "clip.mkv", folder.path() / "s", lens);
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(session->camera);
  EXPECT_EQ(session->camera->size, (ImageSize{64, 48}));
  EXPECT_NEAR(session->camera->lens.K(0, 0), 50, 1e-9);
  EXPECT_NEAR(session->camera->lens.K(0, 2), 31.5, 1e-9);
  EXPECT_EQ(session->camera->readout, SensorDuration(16'000'000)) << "the recording's own";
  lens.camera.size = {128, 72};
  EXPECT_THAT(import_session(folder.path() / "clip.mkv", folder.path() / "t", lens).error().message,
              HasSubstr("128x72"));
}

TEST(Gyroflow, FaultsNameFileAndKey) {
  struct Fault {
    std::string log;
    std::string said;
  };
  const TemporaryFolder folder;
  make_video(folder.path() / "clip.mp4", 5);
  for (const Fault& fault :
       {Fault{"", "not a Gyroflow log"}, Fault{"t,gx\n0,1\n1,2\n", "no rows"},
        Fault{"something else\nt,gx\n", "not a Gyroflow log"},
        Fault{gyroflow_log("orientation,XXZ\n"), "orientation is \"XXZ\""},
        Fault{gyroflow_log("orientation,XY\n"), "orientation is \"XY\""},
        Fault{gyroflow_log("tscale,abc\n"), "tscale is \"abc\""},
        Fault{gyroflow_log("tscale,-1\n"), "tscale is not above 0"},
        Fault{gyroflow_log("tscale,1\n"), "look like milliseconds"},
        Fault{gyroflow_log("frame_readout_direction,7\n"), "frame_readout_direction is \"7\""},
        Fault{gyroflow_log("frame_readout_time,1e9\n"), "frame_readout_time is"},
        Fault{gyroflow_log("") + "1500,x,1,1\n", "line 1507, column gx: found \"x\""},
        Fault{"GYROFLOW IMU LOG\nt,gx,gy,gz\n0,nan,0,0\n1,nan,0,0\n", "not finite"}}) {
    folder.write("clip.gcsv", fault.log);
    const Result<Session> session = open_session(folder.path() / "clip.mp4");
    ASSERT_FALSE(session) << fault.said;
    EXPECT_EQ(session.error().kind, Error::Kind::bad_input);
    EXPECT_THAT(session.error().message, HasSubstr(fault.said));
  }
}

TEST(Import, RefusesAFolderThatHoldsSomething) {
  const TemporaryFolder folder;
  write_ios_log(folder);
  folder.write("s/precious", "x");
  const Result<Session> session = import_session(folder.path() / "log", folder.path() / "s");
  ASSERT_FALSE(session);
  EXPECT_THAT(session.error().message, HasSubstr("exists already"));
  EXPECT_EQ(read(folder.path() / "s/precious"), "x");
}

TEST(Import, LeavesNothingBehindOfAnUnusableRecording) {
  const TemporaryFolder folder;
  write_ios_log(folder);
  folder.write("log/Gyro.txt", "5.0,0,0,0\n5.01,0,0,0\n");
  const Result<Session> session = import_session(folder.path() / "log", folder.path() / "s");
  ASSERT_FALSE(session);
  EXPECT_THAT(session.error().message, HasSubstr("no time in common"));
  EXPECT_THAT(session.error().message, HasSubstr((folder.path() / "log").string()));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "s"));
}

TEST(Import, SaysThatASessionNeedsNone) {
  const TemporaryFolder folder;
  folder.write("session/session.toml", "");
  EXPECT_THAT(import_session(folder.path() / "session", folder.path() / "s").error().message,
              HasSubstr("is a session already"));
}

TEST(Import, NamesTheKindsItKnowsWhenItKnowsNone) {
  const TemporaryFolder folder;
  folder.write("notes.txt", "hello\n");
  folder.write("log/meta.json", "{\"w_cam_from_gyro\": 5}");
  folder.write("other/meta.json", "[1, 2");
  EXPECT_THAT(import_session(folder.path() / "notes.txt", folder.path() / "s").error().message,
              HasSubstr("GoPro MP4"));
  EXPECT_THAT(import_session(folder.path() / "nothing", folder.path() / "s").error().message,
              HasSubstr("no such file"));
  EXPECT_THAT(import_session(folder.path() / "log", folder.path() / "s").error().message,
              HasSubstr("w_cam_from_gyro is missing or wrong; three rows"));
  EXPECT_THAT(import_session(folder.path() / "other", folder.path() / "s").error().message,
              HasSubstr("not a recording of a known kind"));
}

}  // namespace
}  // namespace gimbal
