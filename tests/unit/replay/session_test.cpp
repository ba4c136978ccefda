#include "drivers/replay/session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using test::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::int64_t kEpoch_ns = 1'627'530'745'150'090'001;

SensorTime at(std::int64_t nanoseconds) {
  return SensorTime(SensorDuration(nanoseconds));
}

/// Stamps off the microsecond grid, values that need every digit of a double.
Session recording(const std::filesystem::path& folder) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> value(-3, 3);
  const auto vector = [&] { return Eigen::Vector3d(value(random), value(random), value(random)); };
  Session session;
  session.folder = folder;
  session.device = "a \"phone\" \\ with quotes";
  session.recorded_at = "2021-07-29T03:52:25Z";
  session.quality = "720p";
  CameraCalibration camera;
  camera.size = {1280, 720};
  camera.fps = 24.000384;
  camera.lens.model = LensModel::brown;
  camera.lens.K << 1223.0, 0, 650.4, 0, 1217.5, 345.3, 0, 0, 1;
  camera.lens.distortion = {0.1, -0.20000000000000001, 1e-17, 1.0 / 3};
  camera.readout = SensorDuration(30'000'001);
  camera.readout_direction = ReadoutDirection::right_left;
  camera.time_offset = SensorDuration(-1'000'003);
  camera.timestamp = TimestampReference::readout_end;
  session.camera = camera;
  session.imu.R_camera_imu << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  session.imu.delay = SensorDuration(1'900'001);
  session.imu_clock = "epoch";
  for (int i = 0; i < 200; ++i) {
    session.gyro.push_back({at(kEpoch_ns + i * 10'000'007LL), vector()});
    session.accel.push_back({at(kEpoch_ns + 3 + i * 9'999'999LL), vector() * 5});
  }
  for (int i = 0; i < 40; ++i) {
    const auto exposure = i == 3 ? std::nullopt : std::optional(SensorDuration(5'300'000 + i));
    session.frames.push_back({i, at(kEpoch_ns + 20 + i * 41'666'001LL), exposure});
  }
  return session;
}

TEST(SessionFolder, ComesBackAsItWasWritten) {
  const TemporaryFolder folder;
  const Session written = recording(folder.path() / "session");
  ASSERT_TRUE(write_session(written));
  const Result<Session> read = open_session(folder.path() / "session");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->device, written.device);
  EXPECT_EQ(read->recorded_at, written.recorded_at);
  EXPECT_EQ(read->quality, written.quality);
  EXPECT_EQ(read->imu_clock, written.imu_clock);
  EXPECT_EQ(read->imu.R_camera_imu, written.imu.R_camera_imu);
  EXPECT_EQ(read->imu.delay, written.imu.delay);
  ASSERT_TRUE(read->camera);
  EXPECT_EQ(read->camera->size, written.camera->size);
  EXPECT_EQ(read->camera->fps, written.camera->fps);
  EXPECT_EQ(read->camera->lens.model, written.camera->lens.model);
  EXPECT_EQ(read->camera->lens.K, written.camera->lens.K);
  EXPECT_EQ(read->camera->lens.distortion, written.camera->lens.distortion);
  EXPECT_EQ(read->camera->readout, written.camera->readout);
  EXPECT_EQ(read->camera->readout_direction, written.camera->readout_direction);
  EXPECT_EQ(read->camera->time_offset, written.camera->time_offset);
  EXPECT_EQ(read->camera->timestamp, written.camera->timestamp);
  ASSERT_EQ(read->gyro.size(), written.gyro.size());
  for (std::size_t i = 0; i < written.gyro.size(); ++i) {
    ASSERT_EQ(read->gyro[i].time, written.gyro[i].time);
    ASSERT_EQ(read->gyro[i].gyro_rad_s, written.gyro[i].gyro_rad_s);
    ASSERT_EQ(read->accel[i].time, written.accel[i].time);
    ASSERT_EQ(read->accel[i].accel_m_s2, written.accel[i].accel_m_s2);
  }
  ASSERT_EQ(read->frames.size(), written.frames.size());
  for (std::size_t i = 0; i < written.frames.size(); ++i) {
    ASSERT_EQ(read->frames[i].index, written.frames[i].index);
    ASSERT_EQ(read->frames[i].time, written.frames[i].time);
    ASSERT_EQ(read->frames[i].exposure, written.frames[i].exposure);
  }
}

}  // namespace
}  // namespace gimbal
