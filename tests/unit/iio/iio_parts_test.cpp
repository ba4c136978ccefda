#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "drivers/iio/axes.hpp"
#include "drivers/iio/device_choice.hpp"
#include "drivers/iio/gap_counter.hpp"
#include "drivers/iio/sample_merger.hpp"
#include "drivers/iio/sampling_frequency.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// --- scale, offset, mount matrix ---------------------------------------------------------------

TEST(AxesScaling, OffsetComesBeforeScaleAndTheMountMatrixLast) {
  AxesScaling scaling;
  scaling.scale = {0.5, 0.25, 2};
  scaling.offset = {10, 0, -1};
  scaling.R_board_chip << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // the chip is turned by 90° on the board
  const Eigen::Vector3d out = scaling.apply({2, 8, 4});
  EXPECT_TRUE(out.isApprox(Eigen::Vector3d(-2, 6, 6))) << out.transpose();
}

TEST(MountMatrix, ReadsWhatTheKernelPrints) {
  const auto matrix = parse_mount_matrix("0, 1, 0; -1, 0, 0; 0, 0, 1\n");
  ASSERT_TRUE(matrix) << matrix.error().message;
  EXPECT_EQ((*matrix)(0, 1), 1);
  EXPECT_EQ((*matrix)(1, 0), -1);
  const auto turned = parse_mount_matrix("0.7071, -0.7071, 0; 0.7071, 0.7071, 0; 0, 0, 1");
  EXPECT_TRUE(turned) << turned.error().message;
}

TEST(MountMatrix, RefusesWhatIsNoRotation) {
  for (const std::string text :
       {"", "1, 0, 0", "1, 0, 0; 0, 1, 0; 0, 0", "1; 0; 0; 0; 1; 0; 0; 0; 1",
        "1, 0, 0; 0, 1, 0; 0, 0, 1; 0", "a, b, c; d, e, f; g, h, i", "-1, 0, 0; 0, 1, 0; 0, 0, 1",
        "2, 0, 0; 0, 2, 0; 0, 0, 2", "nan, 0, 0; 0, 1, 0; 0, 0, 1"}) {
    EXPECT_FALSE(parse_mount_matrix(text)) << text;
  }
}

// --- rates -------------------------------------------------------------------------------------

TEST(SamplingFrequency, TakesTheNearestAtOrAboveTheWish) {
  const std::string offers = "12.5 25 50.000000 100 199.99 400 1600\n";
  EXPECT_EQ(nearest_frequency(offers, 150), 199.99);
  EXPECT_EQ(nearest_frequency(offers, 200), 199.99);  // which is what 200 means
  EXPECT_EQ(nearest_frequency(offers, 201.9), 199.99);
  EXPECT_EQ(nearest_frequency(offers, 210), 400);
  EXPECT_EQ(nearest_frequency(offers, 5000), 1600);
  EXPECT_EQ(nearest_frequency("400 100 200", 150), 200);
}

TEST(SamplingFrequency, UnderstandsARange) {
  EXPECT_EQ(nearest_frequency("[10 5 500]", 201), 205);
  EXPECT_EQ(nearest_frequency("[10 5 500]", 200), 200);
  EXPECT_EQ(nearest_frequency("[10 5 500]", 1), 10);
  EXPECT_EQ(nearest_frequency("[10 5 500]", 9999), 500);
}

TEST(SamplingFrequency, OffersNothingWhereNothingIs) {
  EXPECT_FALSE(nearest_frequency("", 100));
  EXPECT_FALSE(nearest_frequency("fast slow 0 -5", 100));
  EXPECT_EQ(highest_frequency("4 1 8 2"), 8);
}

// --- gaps --------------------------------------------------------------------------------------

TEST(GapCounter, CountsWhatIsMissingInAnUnevenStream) {
  std::mt19937 random(3);
  std::normal_distribution<double> jitter_s(0, 0.0004);
  GapCounter counter;
  const std::vector<int> missing{100, 101, 102, 300, 555, 556};
  for (int i = 0; i < 1000; ++i) {
    if (std::find(missing.begin(), missing.end(), i) != missing.end()) continue;
    counter.take(time_from_seconds(100 + 0.005 * i + jitter_s(random)));
  }
  EXPECT_EQ(counter.missing(), missing.size());
}

TEST(GapCounter, ALateSampleIsNotLost) {
  GapCounter counter;
  for (int i = 0; i < 300; ++i) {
    const bool is_late = i % 100 == 50 || i % 100 == 51;  // both come just before the next
    const double late_s = is_late ? (i % 100 == 50 ? 0.0095 : 0.0047) : 0;
    counter.take(time_from_seconds(0.005 * i + late_s));
  }
  EXPECT_EQ(counter.missing(), 0U);
}

/// As from a hub that was kept waiting: what it took meanwhile comes, and is stamped, all at once.
TEST(GapCounter, ABurstMakesUpForThePauseBeforeIt) {
  GapCounter counter;
  double time_s = 100;
  for (int i = 0; i < 300; ++i) counter.take(time_from_seconds(time_s += 0.005));
  time_s += 0.2;
  for (int i = 0; i < 40; ++i) counter.take(time_from_seconds(time_s += 0.00002));
  for (int i = 0; i < 300; ++i) counter.take(time_from_seconds(time_s += 0.005));
  EXPECT_EQ(counter.missing(), 0U);
}

// --- merging -----------------------------------------------------------------------------------

constexpr SensorTime kStart{std::chrono::hours(1)};

GyroSample gyro_at(SensorDuration time) {
  return {kStart + time, Eigen::Vector3d::Zero()};
}

AccelSample accel_at(SensorDuration time) {
  return {kStart + time, Eigen::Vector3d::Zero()};
}

TEST(SampleMerger, PutsTwoDevicesInOrderOfTime) {
  SampleMerger merger(2, milliseconds(100));
  std::vector<ImuReading> out;
  for (int ms = 0; ms < 200; ms += 10) {
    const SensorTime now = kStart + milliseconds(ms + 9);
    merger.push(0, gyro_at(milliseconds(ms)), now);
    merger.push(0, gyro_at(milliseconds(ms + 5)), now);
    if (ms % 40 == 0) {
      for (int late = -37; late < 0; late += 8) {  // a device that delivers in batches
        merger.push(1, accel_at(milliseconds(ms + late)), now);
      }
    }
    while (const auto reading = merger.pop(now)) out.push_back(*reading);
  }
  ASSERT_GT(out.size(), 40U);
  for (std::size_t i = 1; i < out.size(); ++i) EXPECT_GE(time_of(out[i]), time_of(out[i - 1])) << i;
  EXPECT_EQ(merger.dropped(), 0U);
}

TEST(SampleMerger, DoesNotWaitWithoutEndForASilentDevice) {
  SampleMerger merger(2, milliseconds(100));
  merger.push(0, gyro_at({}), kStart + milliseconds(1));
  EXPECT_FALSE(merger.pop(kStart + milliseconds(100)));
  EXPECT_TRUE(merger.pop(kStart + milliseconds(101)));
}

TEST(SampleMerger, WhatComesTooLateIsDroppedAndCounted) {
  SampleMerger merger(2, milliseconds(100));
  merger.push(0, gyro_at(milliseconds(50)), kStart);
  ASSERT_TRUE(merger.pop(kStart + milliseconds(200)));
  merger.push(1, accel_at(milliseconds(40)), kStart + milliseconds(200));
  merger.push(1, accel_at(milliseconds(60)), kStart + milliseconds(200));
  EXPECT_EQ(merger.dropped(), 1U);
  merger.push(0, gyro_at(milliseconds(70)), kStart + milliseconds(200));
  const auto reading = merger.pop(kStart + milliseconds(200));
  ASSERT_TRUE(reading);
  EXPECT_TRUE(std::holds_alternative<AccelSample>(*reading));
}

TEST(SampleMerger, OneDeviceWaitsForNobody) {
  SampleMerger merger(1, milliseconds(100));
  merger.push(0, gyro_at({}), kStart);
  EXPECT_TRUE(merger.pop(kStart));
}

// --- the choice of devices ---------------------------------------------------------------------

IioCandidate gyro(const std::string& id, const std::string& name,
                  const std::string& obstacle = {}) {
  return {.id = id, .name = name, .label = {}, .has_gyro = true, .obstacle = obstacle};
}

IioCandidate accel(const std::string& id, const std::string& name,
                   const std::string& obstacle = {}) {
  return {.id = id, .name = name, .label = {}, .has_accel = true, .obstacle = obstacle};
}

IioCandidate both(const std::string& id, const std::string& name,
                  const std::string& obstacle = {}) {
  return {.id = id,
          .name = name,
          .label = {},
          .has_gyro = true,
          .has_accel = true,
          .obstacle = obstacle};
}

TEST(DeviceChoice, TakesA6AxisDeviceBeforeAPair) {
  const auto choice =
      choose_devices({gyro("d0", "gyro_3d"), accel("d1", "accel_3d"), both("d2", "bmi160")}, {});
  ASSERT_TRUE(choice) << choice.error().message;
  EXPECT_EQ(choice->gyro, "d2");
  EXPECT_EQ(choice->accel, "d2");
}

TEST(DeviceChoice, PairsWhatBelongsTogether) {
  const auto choice = choose_devices({accel("d0", "kxcjk1013"), accel("d1", "accel_3d"),
                                      gyro("d2", "lsm6dso_gyro"), accel("d3", "lsm6dso_accel")},
                                     {});
  ASSERT_TRUE(choice) << choice.error().message;
  EXPECT_EQ(choice->gyro, "d2");
  EXPECT_EQ(choice->accel, "d3");
}

TEST(DeviceChoice, PassesOverWhatIsNotUsable) {
  const auto choice = choose_devices(
      {both("d0", "mpu6050", "has no buffer"), gyro("d1", "gyro_3d"), accel("d2", "accel_3d")}, {});
  ASSERT_TRUE(choice) << choice.error().message;
  EXPECT_EQ(choice->gyro, "d1");
  EXPECT_EQ(choice->accel, "d2");
}

TEST(DeviceChoice, SaysWhatIsInTheWayOfTheOnlyOne) {
  const auto choice = choose_devices({both("iio:device0", "mpu6050", "has no buffer")}, {});
  ASSERT_FALSE(choice);
  EXPECT_EQ(choice.error().message, "iio:device0 (mpu6050): has no buffer");
}

TEST(DeviceChoice, FindsByNameIdOrLabel) {
  auto labelled = both("d1", "bmi160");
  labelled.label = "imu-camera";
  for (const std::string wanted : {"d1", "imu-camera"}) {
    IioImuSettings settings;
    settings.device = wanted;
    const auto choice = choose_devices({both("d0", "bmi160"), labelled}, settings);
    ASSERT_TRUE(choice) << choice.error().message;
    EXPECT_EQ(choice->gyro, "d1") << wanted;
  }
}

TEST(DeviceChoice, NamesWhatIsThereInsteadOfWhatWasAsked) {
  IioImuSettings settings;
  settings.device = "bmi270";
  const auto choice = choose_devices({both("iio:device3", "bmi160")}, settings);
  ASSERT_FALSE(choice);
  EXPECT_EQ(choice.error().kind, Error::Kind::bad_input);
  EXPECT_EQ(choice.error().message,
            "iio: no gyroscope \"bmi270\"; inertial devices here: iio:device3 (bmi160)");
}

TEST(DeviceChoice, DoingWithoutAnAccelerometerIsToBeSaid) {
  IioImuSettings settings;
  EXPECT_FALSE(choose_devices({gyro("d0", "gyro_3d")}, settings));
  settings.accel_device = "none";
  const auto choice = choose_devices({gyro("d0", "gyro_3d")}, settings);
  ASSERT_TRUE(choice) << choice.error().message;
  EXPECT_FALSE(choice->accel);
}

}  // namespace
}  // namespace gimbal
