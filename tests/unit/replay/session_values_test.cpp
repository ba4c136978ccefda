// The numbers of a session, however its files are written.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "drivers/replay/session.hpp"
#include "tests/unit/replay/session_faults.hpp"

namespace gimbal::session_faults {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(SessionValues, AGoodSessionHasNone) {
  const Result<Session> session = open(good_session());
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_THAT(session->warnings, IsEmpty());
  EXPECT_EQ(session->gyro.size(), 200U);
  EXPECT_EQ(session->accel.size(), 200U);
  EXPECT_EQ(session->frames.size(), 30U);
}

class Spelling : public ::testing::TestWithParam<Fault> {};

TEST_P(Spelling, IsNoFault) {
  Files files = good_session();
  GetParam().spoil(files);
  const Result<Session> session = open(files);
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_THAT(session->warnings, IsEmpty());
  const Result<Session> plain = open(good_session());
  EXPECT_EQ(session->frames.size(), plain->frames.size());
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
        Fault{"no_exposure_and_no_last_line_end",
              [](Files& files) {
                std::string text = "index,t_s,exposure_s\n";
                const std::string& frames = files["frames.csv"];
                for (const char c : frames.substr(frames.find('\n') + 1)) {
                  text += c == '\n' ? ",\n" : std::string(1, c);
                }
                text.pop_back();
                files["frames.csv"] = text;
              },
              {}},
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

TEST(SessionValues, AccelerationComesInSpecificForceWhateverTheFileHas) {
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

TEST(SessionValues, AFrameStampThatIsLeftOutLeavesTheOthersTheirPictures) {
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

TEST(SessionValues, ExposuresThatSayNothingAreUnknown) {
  Files files = good_session();
  files["frames.csv"] = "index,t_s,exposure_s\n0,0.5,0.01\n1,0.53,\n2,0.56,nan\n3,0.6,-1\n4,0.63\n";
  const Result<Session> session = open(files);
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_EQ(session->frames.size(), 5U);
  EXPECT_EQ(session->frames[0].exposure, SensorDuration(10'000'000));
  for (std::size_t i = 1; i < 5; ++i) EXPECT_FALSE(session->frames[i].exposure) << i;
}

TEST(SessionValues, EpochTimesKeepTheirMicroseconds) {
  Files files = good_session();
  files.erase("frames.csv");
  files.erase("video.mkv");
  files["gyro.csv"] = "t_s,x,y,z\n1627530745.150090,0,0,0\n1627530745.160091,0,0,0\n";
  const Result<Session> session = open(files);
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->gyro[1].time.time_since_epoch().count(), 1'627'530'745'160'091'000);
}

}  // namespace
}  // namespace gimbal::session_faults
