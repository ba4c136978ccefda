#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "drivers/replay/import/gpmf.hpp"
#include "drivers/replay/import/importer.hpp"
#include "drivers/replay/import/mp4.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/replay/gopro_file.hpp"

namespace gimbal {
namespace {

using test::f32;
using test::klv;
using test::nested;
using test::shorts;
using test::TemporaryFolder;
using test::u16;
using test::u32;
using test::u64;
using ::testing::HasSubstr;

constexpr double kFrame_s = 1001.0 / 30000;

/// One payload's worth: `count` samples, the i-th being (10, 20, i) counts.
std::string vectors(int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += shorts({10, 20, static_cast<std::int16_t>(i)});
  return out;
}

std::string stream(const std::string& stamp, const std::string& orientation, int scale,
                   const std::string& key, const std::string& data) {
  return nested("STRM", stamp + (orientation.empty() ? "" : klv("ORIN", 'c', 1, orientation)) +
                            klv("SCAL", 's', 2, shorts({static_cast<std::int16_t>(scale)})) +
                            klv(key, 's', 6, data));
}

std::string exposures(const std::string& stamp, int count) {
  std::string data;
  for (int i = 0; i < count; ++i) data += f32(0.004F);
  return nested("STRM", stamp + klv("SHUT", 'f', 4, data));
}

std::string readouts() {
  return nested("STRM", klv("SROT", 'f', 4, f32(8.0F) + f32(8.5F) + f32(9.0F)));
}

std::string payload(const std::string& streams) {
  return nested("DEVC", klv("DVID", 'L', 4, u32(1)) + klv("DVNM", 'c', 1, "Hero7 Black") + streams);
}

test::GoProTrack pictures(std::uint32_t count) {
  return {"vide", "avc1", 30000, {{count, 1001}}, std::vector<std::string>(count, "picture")};
}

test::GoProTrack telemetry(std::vector<std::string> payloads) {
  const auto count = static_cast<std::uint32_t>(payloads.size());
  return {"meta", "gpmd", 1000, {{count, 1001}}, std::move(payloads)};
}

std::string stmp(std::uint64_t microseconds) {
  return klv("STMP", 'J', 8, u64(microseconds));
}

/// Two payloads with stamps of their own: the gyro's first sample is 5 ms before the first frame.
std::string stamped_file() {
  return test::mp4_file(
      {pictures(60), telemetry({payload(stream(stmp(80'000), "YxZ", 100, "GYRO", vectors(200)) +
                                        stream(stmp(80'000), "YxZ", 4, "ACCL", vectors(100)) +
                                        exposures(stmp(85'000), 30) + readouts()),
                                payload(stream(stmp(1'080'000), "YxZ", 100, "GYRO", vectors(200)) +
                                        stream(stmp(1'080'000), "YxZ", 4, "ACCL", vectors(100)) +
                                        exposures(stmp(1'086'000), 30))})});
}

/// The session that the first importer who recognises the file makes of it.
Result<Session> import(const std::string& file) {
  const TemporaryFolder folder;
  folder.write("GH010001.MP4", file);
  for (const Importer& importer : importers()) {
    if (importer.recognises(folder.path() / "GH010001.MP4")) {
      return importer.read(folder.path() / "GH010001.MP4");
    }
  }
  return bad_input("not recognised");
}

void expect_time(SensorTime time, double seconds) {
  EXPECT_NEAR(seconds_since_epoch(time), seconds, 2e-9);
}

TEST(ImportGoPro, ScalesAndOrdersAxes) {
  const Result<Session> session = import(stamped_file());
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_EQ(session->gyro.size(), 400U);
  ASSERT_EQ(session->accel.size(), 200U);
  // Columns are y, -x, z: x = -20, y = 10.
  EXPECT_TRUE(session->gyro[7].gyro_rad_s.isApprox(Eigen::Vector3d(-0.2, 0.1, 0.07)));
  EXPECT_TRUE(session->accel[7].accel_m_s2.isApprox(Eigen::Vector3d(-5, 2.5, 1.75)));
  EXPECT_EQ(session->device, "GoPro Hero7 Black");
  EXPECT_FALSE(session->camera);
  ASSERT_TRUE(session->camera_without_lens);
  EXPECT_EQ(session->camera_without_lens->size, (ImageSize{848, 480}));
  EXPECT_NEAR(session->camera_without_lens->fps, 29.97003, 1e-5);
  EXPECT_EQ(session->camera_without_lens->readout, SensorDuration(8'500'000));
  // Up is z for GoPro and -y for the camera; the lens looks along -y, which is the camera's z.
  const Eigen::Matrix3d& R_camera_imu = session->imu.R_camera_imu;
  EXPECT_EQ(R_camera_imu * Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitY());
  EXPECT_EQ(R_camera_imu * -Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
}

TEST(ImportGoPro, PutsTheCamerasOwnStampsOnTheVideosClock) {
  const Result<Session> session = import(stamped_file());
  ASSERT_TRUE(session) << session.error().message;
  expect_time(session->gyro[0].time, -0.005);
  expect_time(session->gyro[100].time, 0.495);
  expect_time(session->gyro[200].time, 0.995);
  expect_time(session->gyro[399].time, 1.99);
  ASSERT_EQ(session->frames.size(), 60U);
  expect_time(session->frames[59].time, 59 * kFrame_s);
  EXPECT_EQ(session->frames[59].exposure, SensorDuration(4'000'000));
}

TEST(ImportGoPro, CountsFramesWhereThereAreNoStamps) {
  const Result<Session> session = import(test::mp4_file(
      {pictures(60),
       telemetry({payload(stream("", "", 1, "GYRO", vectors(171)) + exposures("", 27)),
                  payload(stream("", "", 1, "GYRO", vectors(200)) + exposures("", 33))})}));
  ASSERT_TRUE(session) << session.error().message;
  expect_time(session->gyro[0].time, 0);
  expect_time(session->gyro[171].time, 27 * kFrame_s);
  // Without ORIN columns are z, x, y.
  EXPECT_TRUE(session->gyro[7].gyro_rad_s.isApprox(Eigen::Vector3d(20, 7, 10)));
}

TEST(ImportGoPro, TakesPayloadTimesAsTheLastResort) {
  const Result<Session> session = import(test::mp4_file(
      {pictures(60), telemetry({payload(stream("", "", 1, "GYRO", vectors(200))),
                                payload(stream("", "", 1, "GYRO", vectors(200)))})}));
  ASSERT_TRUE(session) << session.error().message;
  expect_time(session->gyro[100].time, 0.5005);
  expect_time(session->gyro[200].time, 1.001);
  expect_time(session->gyro[300].time, 1.5015);
}

TEST(ImportGoPro, ReadsTheFirstDeviceWithAGyro) {
  const std::string drone =
      nested("DEVC", klv("DVNM", 'c', 1, "Karma") + stream("", "", 1, "GYRO", vectors(50)));
  const std::string strap = nested("DEVC", klv("DVNM", 'c', 1, "Heart") + readouts());
  const Result<Session> session = import(test::mp4_file(
      {pictures(30),
       telemetry({strap + payload(stream("", "", 1, "GYRO", vectors(200))) + drone})}));
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->gyro.size(), 200U);
}

TEST(ImportGoPro, RefusesAnOrientationThatIsNone) {
  const Result<Session> session = import(test::mp4_file(
      {pictures(30), telemetry({payload(stream("", "XXZ", 1, "GYRO", vectors(200)))})}));
  ASSERT_FALSE(session);
  EXPECT_THAT(session.error().message, HasSubstr("\"XXZ\" (ORIN)"));
}

TEST(Mp4, ReadsTablesInChunks) {
  // Three chunks of 2, 2 and 1 samples, 64-bit offsets, one size for all.
  const std::string stbl = test::box(
      "stbl",
      test::box("stts", u32(0) + u32(2) + u32(2) + u32(10) + u32(3) + u32(20)) +
          test::box("stsz", u32(0) + u32(3) + u32(5)) +
          test::box("stsc", u32(0) + u32(2) + u32(1) + u32(2) + u32(1) + u32(3) + u32(1) + u32(1)) +
          test::box("co64", u32(0) + u32(3) + u64(100) + u64(200) + u64(50)));
  const std::string mdhd = test::box("mdhd", u32(1u << 24) + u64(0) + u64(0) + u32(1000) + u64(0));
  const std::string hdlr = test::box("hdlr", u32(0) + u32(0) + "meta");
  const std::string moov = test::box(
      "moov", test::box("trak", test::box("mdia", mdhd + hdlr + test::box("minf", stbl))));
  const TemporaryFolder folder;
  folder.write("a.mp4", test::box("free", std::string(300, 'x')) + moov);
  const auto tracks = read_mp4_tracks(folder.path() / "a.mp4");
  ASSERT_TRUE(tracks);
  ASSERT_EQ(tracks->size(), 1U);
  std::vector<std::uint64_t> offsets;
  std::vector<std::int64_t> times_ms;
  for (const Mp4Sample& sample : tracks->front().samples) {
    offsets.push_back(sample.offset);
    times_ms.push_back(sample.time.count() / 1'000'000);
    EXPECT_EQ(sample.size, 3U);
  }
  EXPECT_THAT(offsets, ::testing::ElementsAre(100, 103, 200, 203, 50));
  EXPECT_THAT(times_ms, ::testing::ElementsAre(0, 10, 20, 40, 60));
}

TEST(Mp4, SaysWhatIsNoMp4) {
  const TemporaryFolder folder;
  folder.write("a.mp4", std::string(1000, 'x'));
  const auto tracks = read_mp4_tracks(folder.path() / "a.mp4");
  ASSERT_FALSE(tracks);
  EXPECT_THAT(tracks.error().message, HasSubstr("no moov box"));
}

/// Reads as much of a damaged file as the importer would; whatever it says, it must come back.
void read_damaged(const TemporaryFolder& folder, const std::string& file) {
  // A new file each time: some file systems wait for the disk when one is cut to nothing.
  std::filesystem::remove(folder.path() / "damaged.mp4");
  folder.write("damaged.mp4", file);
  for (const Importer& importer : importers()) {
    if (!importer.recognises(folder.path() / "damaged.mp4")) continue;
    const Result<Session> session = importer.read(folder.path() / "damaged.mp4");
    if (session) {
      EXPECT_LE(session->gyro.size(), file.size());
    } else {
      EXPECT_FALSE(session.error().message.empty());
    }
  }
}

TEST(ImportGoPro, SurvivesFlippedBytes) {
  const TemporaryFolder folder;
  const std::string good = stamped_file();
  std::mt19937 random(20);
  std::uniform_int_distribution<std::size_t> place(0, good.size() - 1);
  std::uniform_int_distribution<int> value(0, 255);
  std::uniform_int_distribution<int> count(1, 6);
  for (int round = 0; round < 500; ++round) {
    std::string file = good;
    for (int flips = count(random); flips > 0; --flips) {
      file[place(random)] = static_cast<char>(value(random));
    }
    read_damaged(folder, file);
  }
}

TEST(ImportGoPro, SurvivesExtremeNumbersInEveryField) {
  const TemporaryFolder folder;
  const std::string good = stamped_file();
  const std::size_t moov = good.rfind("moov") - 4;
  for (std::size_t at = moov; at + 4 <= good.size(); ++at) {
    for (const std::uint32_t number : {0U, 0xffffffffU}) {
      std::string file = good;
      file.replace(at, 4, u32(number));
      read_damaged(folder, file);
    }
  }
}

TEST(ImportGoPro, SaysWhatAnUnfinishedFileLacks) {
  const TemporaryFolder folder;
  folder.write("cut.mp4", test::box("ftyp", "mp41") + test::u32(1000) + "mdat" + "pictures");
  EXPECT_THAT(import_session(folder.path() / "cut.mp4", folder.path() / "s").error().message,
              HasSubstr("cut.mp4: no moov box"));
}

TEST(ImportGoPro, SurvivesAFileCutAnywhere) {
  const TemporaryFolder folder;
  const std::string good = stamped_file();
  for (std::size_t size = 0; size < good.size(); size += 47) {
    read_damaged(folder, good.substr(0, size));
  }
}

TEST(Gpmf, SamplesSmallerThanTheirNumbersAreNone) {
  const std::string text = payload(
      nested("STRM", klv("SCAL", 'c', 1, "none") + klv("GYRO", 'd', 4, std::string(16, 'x'))));
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  const std::vector<GpmfDevice> devices = parse_gpmf(ByteView(bytes));
  ASSERT_EQ(devices.size(), 1U);
  EXPECT_EQ(devices[0].streams.at(0).sample_count(), 0U);
}

TEST(Gpmf, SurvivesDamage) {
  const std::string good = payload(stream(stmp(80'000), "YxZ", 100, "GYRO", vectors(20)) +
                                   exposures(stmp(85'000), 30) + readouts());
  std::mt19937 random(21);
  std::uniform_int_distribution<std::size_t> place(0, good.size() - 1);
  std::uniform_int_distribution<int> value(0, 255);
  for (int round = 0; round < 20'000; ++round) {
    std::vector<std::uint8_t> bytes(good.begin(), good.end());
    bytes[place(random)] = static_cast<std::uint8_t>(value(random));
    bytes[place(random)] = static_cast<std::uint8_t>(value(random));
    bytes.resize(round % 2 == 0 ? bytes.size() : place(random));
    for (const GpmfDevice& device : parse_gpmf(ByteView(bytes))) {
      for (const GpmfStream& found : device.streams) EXPECT_LE(found.values.size(), bytes.size());
    }
  }
}

struct RealFile {
  const char* path;
  double gyro_rate_hz;
  std::size_t frames;
  double gravity_tolerance_m_s2;
};

void PrintTo(const RealFile& file, std::ostream* out) {
  *out << file.path;
}

class RealGoPro : public ::testing::TestWithParam<RealFile> {};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ssize(values) / 2, values.end());
  return values[values.size() / 2];
}

TEST_P(RealGoPro, HasGravityAndAPlausibleRate) {
  const std::filesystem::path input =
      std::filesystem::path(GIMBALD_SHARED) / "data/logs" / GetParam().path;
  if (!std::filesystem::exists(input)) GTEST_SKIP() << "no recordings: set GIMBALD_SHARED_DIR";
  const TemporaryFolder folder;
  const Result<Session> session = import_session(input, folder.path() / "session");
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->frames.size(), GetParam().frames);
  ASSERT_GT(session->gyro.size(), 1000U);
  const double span_s = to_seconds(session->gyro.back().time - session->gyro.front().time);
  EXPECT_NEAR(static_cast<double>(session->gyro.size() - 1) / span_s, GetParam().gyro_rate_hz,
              0.02 * GetParam().gyro_rate_hz);
  std::vector<double> magnitudes;
  std::vector<double> upward;
  for (const AccelSample& sample : session->accel) {
    magnitudes.push_back(sample.accel_m_s2.norm());
    upward.push_back(-(session->imu.R_camera_imu * sample.accel_m_s2).y());
  }
  EXPECT_NEAR(median(magnitudes), 9.81, GetParam().gravity_tolerance_m_s2);
  EXPECT_GT(median(upward), 8.0) << "all three were held upright: specific force points up";
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "session/thumbnail.jpg"));
}

// The HERO7's accelerometer is not calibrated: one at rest reads 10.74 m/s² (GoPro's answer in
// github.com/gopro/gpmf-parser, issue 136).
INSTANTIATE_TEST_SUITE_P(Files, RealGoPro,
                         ::testing::Values(RealFile{"gopro-hero7/hero7.mp4", 198, 352, 1.1},
                                           RealFile{"gopro-karma/karma.mp4", 397, 362, 0.3},
                                           RealFile{"gopro-max/max-heromode.mp4", 198, 315, 0.3}));

}  // namespace
}  // namespace gimbal
