#include "daemon/bias_memory.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using std::chrono::hours;
using std::chrono::minutes;
using ::testing::HasSubstr;

const WallTime kNow{std::chrono::sys_days(std::chrono::year(2026) / 5 / 4)};
constexpr hours kLongestAge(48);
const GyroBias kBias{{0.0123456789, -0.002, 0.05}, {1e-4, 2e-4, 3e-3}};

class BiasMemoryTest : public ::testing::Test {
 protected:
  [[nodiscard]] BiasMemory memory(const std::string& imu = "iio-auto") const {
    return {file_, kLongestAge, imu};
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "state/bias.toml";
};

/// What the log got while `act` ran.
template <typename Act>
std::string logged_by(const Act& act) {
  ::testing::internal::CaptureStderr();
  act();
  return ::testing::internal::GetCapturedStderr();
}

TEST_F(BiasMemoryTest, TheNextRunKnowsWhatTheLastOneKnew) {
  memory().keep_last(kBias, kNow);
  const auto recalled = memory().recall(kNow + hours(47));
  ASSERT_TRUE(recalled);
  EXPECT_LT((recalled->bias_rad_s - kBias.bias_rad_s).norm(), 1e-10);
  EXPECT_LT((recalled->sigma_rad_s - kBias.sigma_rad_s).norm(), 1e-10);
}

TEST_F(BiasMemoryTest, AFirstRunStartsWithoutAWord) {
  const std::string log = logged_by([&] { EXPECT_FALSE(memory().recall(kNow)); });
  EXPECT_EQ(log, "");
}

TEST_F(BiasMemoryTest, WhatIsOldOrOfAnotherSensorIsNotTaken) {
  memory().keep_last(kBias, kNow);
  EXPECT_FALSE(memory().recall(kNow + hours(49)));
  EXPECT_FALSE(memory().recall(kNow - hours(49)));
  EXPECT_FALSE(memory("iio-bmi160").recall(kNow));
  EXPECT_TRUE(memory().recall(kNow - hours(1)));  // a clock that was set back
}

TEST_F(BiasMemoryTest, ABadFileIsOneWarning) {
  const std::string head = "imu = \"iio-auto\"\nsaved_at_unix_s = 1777852800\n";
  const std::string good = "bias_rad_s = [0.0, 0.0, 0.0]\nsigma_rad_s = [0.1, 0.1, 0.1]\n";
  folder_.write("good.toml", head + good);
  ASSERT_TRUE(read_bias_file(folder_.path() / "good.toml"));
  int number = 0;
  for (const std::string& text : std::vector<std::string>{
           "", "\x80\xff", "imu =", head, good, head + good + "[",
           head + "bias_rad_s = [0, 0]\nsigma_rad_s = [0.1, 0.1, 0.1]\n",
           head + "bias_rad_s = [0, 0, nan]\nsigma_rad_s = [0.1, 0.1, 0.1]\n",
           head + "bias_rad_s = [0, 0, 3]\nsigma_rad_s = [0.1, 0.1, 0.1]\n",
           head + "bias_rad_s = [0, 0, 0]\nsigma_rad_s = [0.1, 0.1, 0]\n",
           head + "bias_rad_s = [0, 0, 0]\nsigma_rad_s = [0.1, 0.1, -0.1]\n",
           "imu = \"iio-auto\"\nsaved_at_unix_s = -9223372036854775808\n" + good,
           "imu = \"iio-auto\"\nsaved_at_unix_s = 9223372036854775807\n" + good,
           "imu = 3\nsaved_at_unix_s = 1777852800\n" + good}) {
    const std::string name =
        fmt::format("bad{}.toml", number++);  // a line that repeats is held back
    folder_.write(name, text);
    const BiasMemory memory(folder_.path() / name, kLongestAge, "iio-auto");
    const std::string log = logged_by([&] { EXPECT_FALSE(memory.recall(kNow)) << text; });
    EXPECT_THAT(log, HasSubstr(name)) << text;
    EXPECT_THAT(log, HasSubstr("learned anew")) << text;
    EXPECT_EQ(std::ranges::count(log, '\n'), 1) << log;
  }
}

TEST_F(BiasMemoryTest, WritesEveryFewMinutesAndAtTheEnd) {
  BiasMemory memory = this->memory();
  memory.keep(kBias, kNow);
  memory.keep(kBias, kNow + minutes(4));
  EXPECT_FALSE(std::filesystem::exists(file_));
  memory.keep(std::nullopt, kNow + minutes(6));
  EXPECT_FALSE(std::filesystem::exists(file_));
  memory.keep(kBias, kNow + minutes(6));
  ASSERT_TRUE(std::filesystem::exists(file_));
  const auto time_in_file = [&] { return read_bias_file(file_).value()->time; };
  EXPECT_EQ(time_in_file(), kNow + minutes(6));
  memory.keep(kBias, kNow + minutes(10));
  EXPECT_EQ(time_in_file(), kNow + minutes(6));
  memory.keep_last(kBias, kNow + minutes(10));
  EXPECT_EQ(time_in_file(), kNow + minutes(10));
}

TEST_F(BiasMemoryTest, SaysOnceThatItCannotWrite) {
  folder_.write("state", "a file where the folder should be");
  BiasMemory memory = this->memory();
  const std::string log = logged_by([&] {
    memory.keep_last(kBias, kNow);
    memory.keep_last(kBias, kNow + minutes(10));
  });
  EXPECT_THAT(log, HasSubstr("state/bias.toml"));
  EXPECT_EQ(std::ranges::count(log, '\n'), 1) << log;
}

TEST_F(BiasMemoryTest, NoFileIsNoMemory) {
  BiasMemory memory({}, kLongestAge, "iio-auto");
  const std::string log = logged_by([&] {
    memory.keep_last(kBias, kNow);
    EXPECT_FALSE(memory.recall(kNow));
  });
  EXPECT_EQ(log, "");
}

TEST_F(BiasMemoryTest, ADeviceIsRememberedInTheServicesFolderARecordingOnlyIfAsked) {
  ASSERT_EQ(::setenv("STATE_DIRECTORY", folder_.path().c_str(), 1), 0);
  Configuration devices;
  devices.source = SourceKind::devices;
  devices.imu.driver = ImuDriver::i2c_lsm6dso;
  devices.imu.i2c.address = {"/dev/i2c-7", 0x6b};
  bias_memory_for(devices).keep_last(kBias, kNow);
  const auto file = folder_.path() / "gyro-bias-i2c_lsm6dso--dev-i2c-7-0x6b.toml";
  EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_TRUE(bias_memory_for(devices).recall(kNow));
  devices.imu.i2c.address.chip = 0x6a;
  EXPECT_FALSE(bias_memory_for(devices).recall(kNow));

  Configuration recording;
  recording.replay.session = "a \"session\"";
  bias_memory_for(recording).keep_last(kBias, kNow);
  recording.bias_memory.file = folder_.path() / "of-recording.toml";
  EXPECT_FALSE(bias_memory_for(recording).recall(kNow));
  bias_memory_for(recording).keep_last(kBias, kNow);
  EXPECT_TRUE(bias_memory_for(recording).recall(kNow));
  ::unsetenv("STATE_DIRECTORY");
}

}  // namespace
}  // namespace gimbal
