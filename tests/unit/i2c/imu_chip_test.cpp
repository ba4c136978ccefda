// Each chip's driver on a bus with a model of the chip.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <numbers>
#include <ostream>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "drivers/i2c/chip_imu.hpp"
#include "drivers/i2c/edge_matcher.hpp"
#include "drivers/i2c_icm42688/icm42688.hpp"
#include "drivers/i2c_lsm6dso/lsm6dso.hpp"
#include "drivers/i2c_mpu6500/mpu6500.hpp"
#include "tests/support/fake_imu_chip.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using Control = std::shared_ptr<test::FakeChipControl>;

/// A chip's driver and model, and what its data sheet says of its sensitivity at 2000 dps and 16 g.
struct ChipUnderTest {
  const char* name;
  std::function<std::unique_ptr<ImuChip>(const Control&, const I2cImuSettings&)> make;
  double dps_per_bit;
  double mg_per_bit;
  std::uint8_t identity_register;
  double nominal_hz;          ///< for 500 asked
  std::uint64_t overflow_at;  ///< samples
};

void PrintTo(const ChipUnderTest& chip, std::ostream* out) {
  *out << chip.name;
}

template <typename Model, auto make>
std::unique_ptr<ImuChip> on_fake_bus(const Control& control, const I2cImuSettings& settings) {
  return make(std::make_unique<Model>(control), settings);
}

const ChipUnderTest kMpu{
    "Mpu6500", on_fake_bus<test::FakeMpu6500, make_mpu6500>, 1 / 16.384, 1e3 / 2048, 0x75, 500, 43};
const ChipUnderTest kLsm{
    "Lsm6dso", on_fake_bus<test::FakeLsm6dso, make_lsm6dso>, 0.070, 0.488, 0x0F, 833.33, 257};
const ChipUnderTest kIcm{
    "Icm42688", on_fake_bus<test::FakeIcm42688, make_icm42688>, 1 / 16.384, 1e3 / 2048, 0x75, 500,
    129};

class ImuChipTest : public ::testing::TestWithParam<ChipUnderTest> {
 protected:
  /// Begins at sample 0, with `waiting` samples in the FIFO.
  void configure_with(std::uint64_t waiting) {
    control_->produced = waiting;
    const auto configured = chip_->configure();
    ASSERT_TRUE(configured) << configured.error().message;
    ASSERT_TRUE(chip_->restart_fifo());
  }

  void expect_sample(const std::optional<ChipReading>& reading, std::uint64_t k) const {
    ASSERT_TRUE(reading);
    ASSERT_TRUE(reading->accel_m_s2);
    const auto gyro = test::fake_gyro(k);
    const auto accel = test::fake_accel(k);
    for (int axis = 0; axis < 3; ++axis) {
      const double rad_s =
          gyro.at(static_cast<std::size_t>(axis)) * GetParam().dps_per_bit * std::numbers::pi / 180;
      const double m_s2 =
          accel.at(static_cast<std::size_t>(axis)) * GetParam().mg_per_bit * 9.80665e-3;
      EXPECT_NEAR(reading->gyro_rad_s[axis], rad_s, 1e-9 + 1e-3 * std::abs(rad_s)) << k;
      EXPECT_NEAR((*reading->accel_m_s2)[axis], m_s2, 1e-9 + 1e-3 * std::abs(m_s2)) << k;
    }
  }

  Control control_ = std::make_shared<test::FakeChipControl>();
  std::unique_ptr<ImuChip> chip_ = GetParam().make(control_, {});
};

TEST_P(ImuChipTest, ReadsItsFifoInOrderAndUnits) {
  configure_with(9);
  const auto level = chip_->fifo_level();
  ASSERT_TRUE(level);
  EXPECT_EQ(level->samples, 9U);
  EXPECT_FALSE(level->has_overflowed);
  const auto readings = chip_->read_fifo(5);  // not all that is there
  ASSERT_TRUE(readings) << readings.error().message;
  ASSERT_EQ(readings->size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) expect_sample((*readings)[k], k);
  EXPECT_EQ(chip_->fifo_level()->samples, 4U);
  expect_sample((*chip_->read_fifo(4))[3], 8);
}

TEST_P(ImuChipTest, ReadsTheSameInShortTransfers) {
  control_->most_bytes = 32;  // as SMBus has them
  configure_with(20);
  const auto readings = chip_->read_fifo(20);
  ASSERT_TRUE(readings) << readings.error().message;
  for (std::size_t k = 0; k < 20; ++k) expect_sample((*readings)[k], k);
}

TEST_P(ImuChipTest, SeesThatItsFifoRanOver) {
  configure_with(GetParam().overflow_at);
  EXPECT_TRUE(chip_->fifo_level()->has_overflowed);
}

TEST_P(ImuChipTest, TakesTheNearestRateAboveTheWish) {
  EXPECT_NEAR(1 / to_seconds(chip_->nominal_period()), GetParam().nominal_hz, 0.01);
}

TEST_P(ImuChipTest, RefusesAnotherChipAndLeavesItAlone) {
  control_->registers[GetParam().identity_register] = 0xEA;
  const auto before = control_->registers;
  const auto configured = chip_->configure();
  ASSERT_FALSE(configured);
  EXPECT_NE(configured.error().message.find("reads 0xea, expected 0x"), std::string::npos)
      << configured.error().message;
  auto after = control_->registers;
  after[0x76] = before[0x76];  // the ICM's bank has to be chosen first
  EXPECT_EQ(after, before);
}

INSTANTIATE_TEST_SUITE_P(Chips, ImuChipTest, ::testing::Values(kMpu, kLsm, kIcm),
                         [](const auto& it) -> std::string { return it.param.name; });

// --- what is common: the bus, the FIFO's overflow, the fall-back ---------------------------------

class ChipImuTest : public ::testing::Test {
 protected:
  void SetUp() override { make({}); }

  void make(const I2cImuSettings& settings) {
    imu_ = make_chip_imu(kMpu.make(control_, settings), settings, nullptr);
  }

  std::vector<GyroSample> read_gyro(std::size_t count) const {
    std::vector<GyroSample> samples;
    while (samples.size() < count) {
      const auto reading = imu_->read();
      if (!reading || !*reading) {
        ADD_FAILURE() << (reading ? "ended" : reading.error().message);
        return samples;
      }
      if (const auto* gyro = std::get_if<GyroSample>(&**reading)) samples.push_back(*gyro);
    }
    return samples;
  }

  Control control_ = std::make_shared<test::FakeChipControl>();
  std::unique_ptr<ImuSource> imu_;
};

TEST_F(ChipImuTest, ADisturbedBusIsAskedAgain) {
  ASSERT_TRUE(imu_->start());
  read_gyro(10);
  control_->refusals = 2;
  read_gyro(100);
  control_->refusals = 3;
  read_gyro(100);
}

TEST_F(ChipImuTest, AnOverflowIsCountedAndGotOver) {
  ASSERT_TRUE(imu_->start());
  read_gyro(200);
  std::this_thread::sleep_for(milliseconds(300));  // 150 samples into a FIFO for 42
  const auto samples = read_gyro(50);
  EXPECT_GE(imu_->lost(), 100U);
  ASSERT_EQ(imu_->remarks().size(), 1U);
  for (std::size_t i = 1; i < samples.size(); ++i) EXPECT_GT(samples[i].time, samples[i - 1].time);
}

TEST_F(ChipImuTest, AFifoThatStaysEmptyIsReplacedByPolling) {
  control_->produced = 0;  // as on an emulated bus whose registers are plain memory
  ASSERT_TRUE(imu_->start());
  control_->registers[0x43] = 0x01;  // GYRO_XOUT_H
  const auto samples = read_gyro(20);
  ASSERT_EQ(samples.size(), 20U);
  EXPECT_NEAR(samples.back().gyro_rad_s.x(), 256 / 16.384 * std::numbers::pi / 180, 1e-6);
  ASSERT_EQ(imu_->remarks().size(), 1U);
}

TEST_F(ChipImuTest, AChipThatFallsSilentIsAnError) {
  I2cImuSettings settings;
  // Well above what the FIFO holds: a machine that stands still for that long is no silence.
  settings.silence_limit = milliseconds(500);
  make(settings);
  ASSERT_TRUE(imu_->start());
  read_gyro(20);
  control_->is_asleep = true;
  Result<std::optional<ImuReading>> reading;
  do {
    reading = imu_->read();
  } while (reading && *reading);
  ASSERT_FALSE(reading);
  EXPECT_NE(reading.error().message.find("no sample for"), std::string::npos);
}

TEST(EdgeMatcher, TakesTheNearestEdgeAndDoesWithout) {
  const auto at = [](int microseconds) {
    return SensorTime(std::chrono::microseconds(microseconds));
  };
  EdgeMatcher matcher;
  for (const int edge : {10, 1010, 3010, 4010}) matcher.take(at(edge));  // 2010 was lost
  EXPECT_EQ(matcher.match(at(60), milliseconds(1)), at(10));
  EXPECT_EQ(matcher.match(at(960), milliseconds(1)), at(1010));
  EXPECT_EQ(matcher.match(at(2060), milliseconds(1)), at(2060));
  EXPECT_EQ(matcher.match(at(3060), milliseconds(1)), at(3010));
  EXPECT_EQ(matcher.match(at(4060), milliseconds(1)), at(4010));
}

TEST(I2cAddress, ReadsBusAndChip) {
  const auto address = parse_i2c_address("/dev/i2c-3:0x69");
  ASSERT_TRUE(address) << address.error().message;
  EXPECT_EQ(address->bus, "/dev/i2c-3");
  EXPECT_EQ(address->chip, 0x69);
  EXPECT_EQ(to_string(*address), "/dev/i2c-3:0x69");
  for (const char* text : {"", "/dev/i2c-1", "/dev/i2c-1:68", ":0x68", "/dev/i2c-1:0x",
                           "/dev/i2c-1:0x80", "/dev/i2c-1:0x6g"}) {
    EXPECT_FALSE(parse_i2c_address(text)) << text;
  }
}

TEST(I2cDevice, ABusThatIsNotThereIsNamed) {
  const auto imu = open_i2c_mpu6500({.address = {"/dev/i2c-987", 0x68}});
  ASSERT_FALSE(imu);
  EXPECT_NE(imu.error().message.find("/dev/i2c-987:0x68: there is no such bus"), std::string::npos);
}

}  // namespace
}  // namespace gimbal
