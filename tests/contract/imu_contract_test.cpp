// What drivers/imu_source.hpp promises of a live device, asked of every driver that has one. On any
// computer: a recording at its own pace, and the I²C drivers on models of their chips. Where the
// environment names a device, the real ones, too:
//   GIMBALD_TEST_IIO=auto|NAME  GIMBALD_TEST_I2C_MPU=/dev/i2c-N:0x68
//   GIMBALD_TEST_GPIO=gpiochipN:LINE
// The line of the last is for data-ready edges of the MPU.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "drivers/clock/monotonic_now.hpp"
#include "drivers/i2c/chip_imu.hpp"
#include "drivers/i2c_icm42688/icm42688.hpp"
#include "drivers/i2c_lsm6dso/lsm6dso.hpp"
#include "drivers/i2c_mpu6500/mpu6500.hpp"
#include "drivers/imu_source.hpp"
#include "drivers/replay/paced_replay.hpp"
#include "tests/support/fake_imu_chip.hpp"
#ifdef GIMBALD_TEST_WITH_IIO
#include "drivers/iio/iio_imu.hpp"
#endif
#ifdef GIMBALD_TEST_WITH_GPIO
#include "drivers/gpio/gpio_edges.hpp"
#endif

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// A live IMU, and what can be done to its device.
struct LiveImu {
  std::unique_ptr<ImuSource> imu;
  std::function<void()> unplug = {};  ///< empty if it cannot be
  std::function<void()> flood = {};   ///< has the device lose samples; empty if it cannot be
  std::function<void()> before_start = {};
};

struct LiveDriver {
  const char* name;
  std::function<Result<LiveImu>()> open;
  const char* variable = nullptr;  ///< that must name the device
};

void PrintTo(const LiveDriver& driver, std::ostream* out) {
  *out << driver.name;
}

SensorTime time_of(const ImuReading& reading) {
  return std::visit([](const auto& sample) { return sample.time; }, reading);
}

class ImuContract : public ::testing::TestWithParam<LiveDriver> {
 protected:
  void SetUp() override {
    const char* variable = GetParam().variable;
    if (variable != nullptr && std::getenv(variable) == nullptr) {
      GTEST_SKIP() << "no device to test: " << variable << " is not set";
    }
    auto opened = GetParam().open();
    ASSERT_TRUE(opened) << opened.error().message;
    device_ = *std::move(opened);
  }

  void start() const {
    if (device_.before_start) device_.before_start();
    const auto started = device_.imu->start();
    ASSERT_TRUE(started) << started.error().message;
  }

  std::vector<ImuReading> read(std::size_t count) const {
    std::vector<ImuReading> readings;
    while (readings.size() < count) {
      const auto reading = device_.imu->read();
      if (!reading || !*reading) {
        ADD_FAILURE() << (reading ? "ended" : reading.error().message);
        return readings;
      }
      readings.push_back(**reading);
    }
    return readings;
  }

  LiveImu device_;
};

TEST_P(ImuContract, StampsAreOnCLOCK_MONOTONICAndRise) {
  start();
  const SensorTime before = monotonic_now();
  std::optional<SensorTime> last_gyro;
  std::optional<SensorTime> last;
  for (const ImuReading& reading : read(150)) {
    const SensorTime time = time_of(reading);
    EXPECT_GT(time, before - seconds(1));
    EXPECT_LE(time, monotonic_now());
    if (last) {
      EXPECT_GE(time, *last);
    }
    last = time;
    if (!std::holds_alternative<GyroSample>(reading)) continue;
    if (last_gyro) {
      EXPECT_GT(time, *last_gyro);
    }
    last_gyro = time;
  }
  EXPECT_TRUE(last_gyro);
}

TEST_P(ImuContract, StopEndsAReadThatWaits) {
  start();
  read(20);
  std::thread stopper([this] {
    std::this_thread::sleep_for(milliseconds(50));
    device_.imu->stop();
  });
  const SensorTime begin = monotonic_now();
  Result<std::optional<ImuReading>> reading;
  do {
    reading = device_.imu->read();
  } while (reading && *reading && monotonic_now() - begin < seconds(20));
  stopper.join();
  ASSERT_TRUE(reading) << reading.error().message;
  EXPECT_FALSE(*reading);
  EXPECT_FALSE(*device_.imu->read());  // and stays so
}

TEST_P(ImuContract, StartsAgain) {
  start();
  const auto before = read(50);
  device_.imu->stop();
  start();
  const auto after = read(50);
  ASSERT_FALSE(before.empty() || after.empty());
  EXPECT_GT(time_of(after.back()), time_of(before.back()));
  start();  // without a stop, too
  read(10);
}

TEST_P(ImuContract, LosesNothingWhenItIsReadInTime) {
  // A machine that stands still for a moment misses samples that nobody could have read: not each
  // time.
  constexpr int kAttempts = 5;
  std::vector<std::uint64_t> lost;
  do {
    start();
    read(300);
    lost.push_back(device_.imu->lost());
  } while (lost.back() > 0 && lost.size() < kAttempts);
  EXPECT_EQ(lost.back(), 0U) << "before: " << ::testing::PrintToString(lost);
}

TEST_P(ImuContract, CountsWhatTheDeviceLost) {
  if (!device_.flood) GTEST_SKIP() << "this device cannot be made to lose samples here";
  start();
  read(100);
  device_.flood();
  read(100);
  EXPECT_GT(device_.imu->lost(), 0U);
}

TEST_P(ImuContract, ADeviceThatIsGoneIsAnErrorInTime) {
  if (!device_.unplug) GTEST_SKIP() << "this device cannot be unplugged here";
  start();
  read(20);
  device_.unplug();
  const SensorTime begin = monotonic_now();
  Result<std::optional<ImuReading>> reading;
  do {
    reading = device_.imu->read();
  } while (reading && *reading);
  ASSERT_FALSE(reading);
  EXPECT_FALSE(reading.error().message.empty());
  EXPECT_LT(to_seconds(monotonic_now() - begin), 5.0);
  EXPECT_FALSE(device_.imu->start());
}

/// A second of both sensors, over and over.
Result<LiveImu> open_paced_replay() {
  Session session;
  for (int i = 0; i < 500; ++i) {
    const SensorTime time(std::chrono::hours(7) + i * milliseconds(2));
    session.gyro.push_back({time, Eigen::Vector3d(0.1, 0.2, 0.3)});
    session.accel.push_back({time, Eigen::Vector3d(0, 0, 9.8)});
  }
  auto timeline = std::make_shared<ReplayTimeline>(session);
  LiveImu live;
  live.imu = std::make_unique<PacedImu>(session, timeline, Repeat::forever);
  live.before_start = [timeline] { timeline->begin_at(monotonic_now()); };  // as its camera does
  return live;
}

/// Slow, so that a busy computer does not let the FIFO run over, and 1 % slower than promised.
template <typename Model, auto make>
Result<LiveImu> open_on_fake_bus() {
  auto control = std::make_shared<test::FakeChipControl>();
  I2cImuSettings settings;
  settings.rate_hz = 100;
  auto chip = make(std::make_unique<Model>(control), settings);
  control->period_s = 1.01 * to_seconds(chip->nominal_period());
  LiveImu live;
  live.imu = make_chip_imu(std::move(chip), settings, nullptr);
  live.unplug = [control] { control->is_unplugged = true; };
  live.flood = [control] { control->flood += 1000; };
  return live;
}

#ifdef GIMBALD_TEST_WITH_IIO
Result<LiveImu> open_iio() {
  IioImuSettings settings;
  settings.device = std::getenv("GIMBALD_TEST_IIO");
  auto imu = open_iio_imu(settings);
  if (!imu) return tl::unexpected(imu.error());
  return LiveImu{*std::move(imu)};
}
#endif

Result<LiveImu> open_mpu() {
  const auto address = parse_i2c_address(std::getenv("GIMBALD_TEST_I2C_MPU"));
  if (!address) return tl::unexpected(address.error());
  std::unique_ptr<EdgeSource> edges;
#ifdef GIMBALD_TEST_WITH_GPIO
  if (const char* line = std::getenv("GIMBALD_TEST_GPIO")) {
    const auto gpio = parse_gpio_address(line);
    if (!gpio) return tl::unexpected(gpio.error());
    edges = open_gpio_edges({.address = *gpio, .edges = GpioEdges::rising});
  }
#endif
  auto imu = open_i2c_mpu6500({.address = *address, .rate_hz = 100}, std::move(edges));
  if (!imu) return tl::unexpected(imu.error());
  return LiveImu{*std::move(imu)};
}

std::vector<LiveDriver> all_drivers() {
  std::vector<LiveDriver> drivers{
      {"PacedReplay", open_paced_replay},
      {"FakeMpu6500", open_on_fake_bus<test::FakeMpu6500, make_mpu6500>},
      {"FakeLsm6dso", open_on_fake_bus<test::FakeLsm6dso, make_lsm6dso>},
      {"FakeIcm42688", open_on_fake_bus<test::FakeIcm42688, make_icm42688>},
      {"Mpu6500", open_mpu, "GIMBALD_TEST_I2C_MPU"}};
#ifdef GIMBALD_TEST_WITH_IIO
  drivers.push_back({"Iio", open_iio, "GIMBALD_TEST_IIO"});
#endif
  return drivers;
}

INSTANTIATE_TEST_SUITE_P(Drivers, ImuContract, ::testing::ValuesIn(all_drivers()),
                         [](const auto& driver) -> std::string { return driver.param.name; });

}  // namespace
}  // namespace gimbal
