#include "drivers/i2c_mpu6500/mpu6500.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "drivers/i2c/open_chip.hpp"
#include "drivers/i2c/probe.hpp"
#include "drivers/i2c_mpu6500/mpu6500_registers.hpp"

namespace gimbal {
namespace {

using namespace mpu6500;  // NOLINT(google-build-using-namespace): register names
using std::chrono::milliseconds;

constexpr std::uint8_t kIdentity6050 = 0x68;
constexpr std::array kMembers{ChipIdentity{kIdentity6050, "MPU-6050"},
                              ChipIdentity{0x70, "MPU-6500"}, ChipIdentity{0x71, "MPU-9250"},
                              ChipIdentity{0x73, "MPU-9255"}, ChipIdentity{0x74, "MPU-6515"}};
constexpr std::array<std::uint8_t, 2> kAddresses{0x68, 0x69};
constexpr ChipFamily kFamily{"i2c_mpu6500", kIdentity, kMembers, kAddresses};

constexpr double kFilteredRate_hz = 1000;  // what the divider divides once a filter is on
constexpr std::size_t kFrame = 12;         // accelerometer, then gyroscope
constexpr std::size_t kFifoSize6050 = 1024;
constexpr std::size_t kFifoSize6500 = 512;

/// Bandwidths of DLPF_CFG 1 to 6, in hertz; the accelerometer's are near these.
constexpr std::array<double, 6> kBandwidths_hz{184, 92, 41, 20, 10, 5};

class Mpu6500 final : public ImuChip {
 public:
  Mpu6500(std::unique_ptr<I2cDevice> device, const I2cImuSettings& settings)
      : device_(std::move(device)), settings_(settings) {
    const double divisor = std::floor(kFilteredRate_hz / settings.rate_hz + 0.01);
    divisor_ = static_cast<int>(std::clamp(divisor, 1.0, 256.0));
  }

  [[nodiscard]] std::string title() const override { return device_->title(); }
  [[nodiscard]] Result<void> configure() override;
  [[nodiscard]] SensorDuration nominal_period() const override { return milliseconds(divisor_); }
  [[nodiscard]] Result<FifoLevel> fifo_level() override;
  [[nodiscard]] Result<std::vector<std::optional<ChipReading>>> read_fifo(
      std::size_t samples) override;
  [[nodiscard]] Result<void> restart_fifo() override;
  [[nodiscard]] Result<ChipReading> read_latest() override;

 private:
  [[nodiscard]] Result<void> identify_chip();
  [[nodiscard]] Result<void> set_ranges();
  [[nodiscard]] std::uint8_t filter_bits() const;
  std::unique_ptr<I2cDevice> device_;
  I2cImuSettings settings_;
  int divisor_;
  bool is_6050_ = false;
};

Result<void> Mpu6500::configure() {
  if (auto known = identify_chip(); !known) return known;
  if (auto done = device_->write(kPower1, kPower1Reset); !done) return done;
  std::this_thread::sleep_for(milliseconds(100));  // as the register map asks
  if (auto done = device_->write(kPower1, kPower1Gyro); !done) return done;
  std::this_thread::sleep_for(milliseconds(35));  // gyroscope start-up time
  if (auto done = device_->write(kPower2, 0); !done) return done;
  return set_ranges();
}

/// Nothing is written to a chip that is not known.
Result<void> Mpu6500::identify_chip() {
  if (const auto name = identify(*device_, kFamily); !name) return tl::unexpected(name.error());
  const auto identity = device_->read_byte(kIdentity);
  if (!identity) return tl::unexpected(identity.error());
  is_6050_ = *identity == kIdentity6050;
  return {};
}

Result<void> Mpu6500::set_ranges() {
  const std::uint8_t gyro = settings_.gyro_range == GyroRange::dps_2000 ? 0x18 : 0x10;
  const std::uint8_t accel = settings_.accel_range == AccelRange::g_16 ? 0x18 : 0x10;
  const std::array<RegisterValue, 6> values{
      {{kFilter, filter_bits()},
       {kRateDivider, static_cast<std::uint8_t>(divisor_ - 1)},
       {kGyroConfig, gyro},
       {kAccelConfig, accel},
       {kInterruptPin, 0},  // pulses of 50 µs, rising
       {kInterruptEnable, kInterruptDataReady}}};
  if (auto done = device_->write_all(values); !done) return done;
  if (!is_6050_) {
    if (auto done = device_->write(kAccelFilter, filter_bits()); !done) return done;
  }
  const auto set = device_->read_byte(kGyroConfig);
  if (!set) return tl::unexpected(set.error());
  if (*set != gyro) {
    return failed(fmt::format("{}: register {:#04x} reads {:#04x} after {:#04x} was written",
                              title(), kGyroConfig, *set, gyro));
  }
  return {};
}

/// The widest that keeps half the rate out.
std::uint8_t Mpu6500::filter_bits() const {
  const double nyquist_hz = kFilteredRate_hz / divisor_ / 2;
  for (std::size_t i = 0; i < kBandwidths_hz.size(); ++i) {
    if (kBandwidths_hz.at(i) <= nyquist_hz) return static_cast<std::uint8_t>(i + 1);
  }
  return kBandwidths_hz.size();
}

/// A FIFO that runs over writes on over its oldest frame, which leaves no frame's beginning to
/// find.
Result<FifoLevel> Mpu6500::fifo_level() {
  std::array<std::uint8_t, 2> count{};
  if (auto got = device_->read(kFifoCount, count); !got) return tl::unexpected(got.error());
  const auto bytes = static_cast<std::size_t>(count[0] << 8 | count[1]);
  const std::size_t size = is_6050_ ? kFifoSize6050 : kFifoSize6500;
  return FifoLevel{.samples = bytes / kFrame, .has_overflowed = bytes + kFrame > size};
}

Result<std::vector<std::optional<ChipReading>>> Mpu6500::read_fifo(std::size_t samples) {
  std::vector<std::uint8_t> bytes(samples * kFrame);
  const std::size_t chunk = device_->longest_read() / kFrame * kFrame;
  for (std::size_t at = 0; at < bytes.size(); at += chunk) {
    const auto part = std::span(bytes).subspan(at, std::min(chunk, bytes.size() - at));
    if (auto got = device_->read_once(kFifoPort, part); !got) return tl::unexpected(got.error());
  }
  std::vector<std::optional<ChipReading>> readings;
  for (std::size_t i = 0; i < samples; ++i) {
    const std::uint8_t* frame = &bytes[i * kFrame];
    readings.emplace_back(full_scale_reading(settings_, frame, frame + 6));
  }
  return readings;
}

Result<void> Mpu6500::restart_fifo() {
  const std::array<RegisterValue, 4> values{{{kFifoSources, 0},
                                             {kUserControl, kUserFifoReset},
                                             {kUserControl, kUserFifoOn},
                                             {kFifoSources, kFifoGyroAccel}}};
  return device_->write_all(values);
}

Result<ChipReading> Mpu6500::read_latest() {
  std::array<std::uint8_t, 14> bytes{};
  if (auto got = device_->read(kData, bytes); !got) return tl::unexpected(got.error());
  return full_scale_reading(settings_, bytes.data(), &bytes[8]);
}

}  // namespace

std::unique_ptr<ImuChip> make_mpu6500(std::unique_ptr<I2cDevice> device,
                                      const I2cImuSettings& settings) {
  return std::make_unique<Mpu6500>(std::move(device), settings);
}

Result<std::unique_ptr<ImuSource>> open_i2c_mpu6500(const I2cImuSettings& settings,
                                                    std::unique_ptr<EdgeSource> data_ready) {
  return open_chip(kFamily, make_mpu6500, settings, std::move(data_ready));
}

std::vector<DeviceReport> list_i2c_mpu6500() {
  return probe_buses(kFamily);
}

}  // namespace gimbal
