// What drivers/imu_source.hpp promises, asked of every driver. A new driver adds itself to the list
// at the end of this file.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "drivers/imu_source.hpp"
#include "drivers/replay/replay_imu.hpp"
#include "drivers/synthetic/hand_motion.hpp"
#include "drivers/synthetic/synthetic_imu.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;

/// An IMU that delivers a second of both sensors and ends, and how much that is.
struct ImuUnderTest {
  std::unique_ptr<ImuSource> imu;
  std::size_t gyro_samples;
  std::size_t accel_samples;
};

struct ImuDriver {
  const char* name;
  std::function<ImuUnderTest()> make;
};

void PrintTo(const ImuDriver& driver, std::ostream* out) {
  *out << driver.name;
}

SensorTime time_of(const ImuReading& reading) {
  return std::visit([](const auto& sample) { return sample.time; }, reading);
}

Eigen::Vector3d value_of(const ImuReading& reading) {
  const auto* gyro = std::get_if<GyroSample>(&reading);
  return gyro != nullptr ? gyro->gyro_rad_s : std::get<AccelSample>(reading).accel_m_s2;
}

class ImuSourceContract : public ::testing::TestWithParam<ImuDriver> {
 protected:
  ImuUnderTest test_ = GetParam().make();

  [[nodiscard]] std::vector<ImuReading> read_to_end() const {
    std::vector<ImuReading> readings;
    for (;;) {
      const auto reading = test_.imu->read();
      if (!reading) {
        ADD_FAILURE() << reading.error().message;
        return readings;
      }
      if (!*reading) {
        return readings;
      }
      readings.push_back(**reading);
    }
  }
};

TEST_P(ImuSourceContract, NoSampleIsLost) {
  ASSERT_TRUE(test_.imu->start());
  std::size_t gyro_samples = 0;
  std::size_t accel_samples = 0;
  for (const ImuReading& reading : read_to_end()) {
    ++(std::holds_alternative<GyroSample>(reading) ? gyro_samples : accel_samples);
    EXPECT_TRUE(value_of(reading).allFinite());
  }
  EXPECT_EQ(gyro_samples, test_.gyro_samples);
  EXPECT_EQ(accel_samples, test_.accel_samples);
}

TEST_P(ImuSourceContract, SamplesComeInOrderOfTime) {
  ASSERT_TRUE(test_.imu->start());
  const auto readings = read_to_end();
  for (std::size_t i = 1; i < readings.size(); ++i) {
    EXPECT_GE(time_of(readings[i]), time_of(readings[i - 1])) << i;
  }
}

TEST_P(ImuSourceContract, TheEndIsTheEnd) {
  ASSERT_TRUE(test_.imu->start());
  ASSERT_FALSE(read_to_end().empty());
  for (int i = 0; i < 3; ++i) {
    const auto reading = test_.imu->read();
    ASSERT_TRUE(reading) << reading.error().message;
    EXPECT_FALSE(reading->has_value());
  }
}

TEST_P(ImuSourceContract, NothingComesAfterStop) {
  ASSERT_TRUE(test_.imu->start());
  const auto first = test_.imu->read();
  ASSERT_TRUE(first && *first);
  test_.imu->stop();
  test_.imu->stop();  // once more is harmless
  const auto reading = test_.imu->read();
  ASSERT_TRUE(reading) << reading.error().message;
  EXPECT_FALSE(reading->has_value());
}

TEST_P(ImuSourceContract, StartsAgainAtTheFirstSample) {
  ASSERT_TRUE(test_.imu->start());
  const auto before = read_to_end();
  test_.imu->stop();
  ASSERT_TRUE(test_.imu->start());
  const auto interrupted = test_.imu->read();  // from the middle, too
  ASSERT_TRUE(interrupted && *interrupted);
  test_.imu->stop();
  ASSERT_TRUE(test_.imu->start());
  const auto after = read_to_end();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(after[i].index(), before[i].index());
    EXPECT_EQ(time_of(after[i]), time_of(before[i]));
    EXPECT_EQ(value_of(after[i]), value_of(before[i]));
  }
}

ImuUnderTest replay_imu() {
  Session session;
  for (int i = 0; i < 100; ++i) {
    const SensorTime time(std::chrono::hours(7) + i * milliseconds(10));
    session.gyro.push_back({time, Eigen::Vector3d(0.1 * i, 0.2, 0.3)});
    if (i % 2 == 1) {
      session.accel.push_back({time + milliseconds(3), Eigen::Vector3d(0, 0.01 * i, 9.8)});
    }
  }
  return {std::make_unique<ReplayImu>(session), 100, 50};
}

ImuUnderTest synthetic_imu() {
  SyntheticImuSettings settings;
  settings.span = {SensorTime(), SensorTime(std::chrono::seconds(1))};
  settings.gyro_clock = {400.0, {}};
  settings.accel_clock = {100.0, milliseconds(3)};
  settings.gyro.noise_density = 1e-4;
  auto imu =
      SyntheticImu::create(settings, make_hand_motion(walking_hand(), std::chrono::seconds(1), 1));
  EXPECT_TRUE(imu) << imu.error().message;
  return {*std::move(imu), 400, 100};
}

INSTANTIATE_TEST_SUITE_P(Drivers, ImuSourceContract,
                         ::testing::Values(ImuDriver{"Replay", replay_imu},
                                           ImuDriver{"Synthetic", synthetic_imu}),
                         [](const auto& driver) -> std::string { return driver.param.name; });

}  // namespace
}  // namespace gimbal
