#include "drivers/i2c_lsm6dso/lsm6dso.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>
#include <utility>

#include "drivers/i2c/open_chip.hpp"
#include "drivers/i2c/probe.hpp"
#include "drivers/i2c_lsm6dso/lsm6dso_registers.hpp"
#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {
namespace {

using namespace lsm6dso;  // NOLINT(google-build-using-namespace): register names
using std::chrono::milliseconds;

constexpr std::array kMembers{ChipIdentity{0x6C, "LSM6DSO or LSM6DSOX"},
                              ChipIdentity{0x6B, "LSM6DSR or ISM330DHCX"}};
constexpr std::array<std::uint8_t, 2> kAddresses{0x6A, 0x6B};
constexpr ChipFamily kFamily{"i2c_lsm6dso", kIdentity, kMembers, kAddresses};

/// Rates for codes 1 and up of ODR_XL, ODR_G, BDR_XL and BDR_GY, in hertz.
constexpr std::array<double, 8> kRates_hz{12.5, 26, 52, 104, 208, 416.67, 833.33, 1666.67};

constexpr std::size_t kWord = 7;  // a tag and three numbers

std::uint8_t rate_code(double wish_hz) {
  const auto* rate = std::lower_bound(kRates_hz.begin(), kRates_hz.end(), 0.96 * wish_hz);
  const auto index = std::min<std::ptrdiff_t>(rate - kRates_hz.begin(), kRates_hz.size() - 1);
  return static_cast<std::uint8_t>(index + 1);
}

class Lsm6dso final : public ImuChip {
 public:
  Lsm6dso(std::unique_ptr<I2cDevice> device, const I2cImuSettings& settings)
      : device_(std::move(device)), settings_(settings), rate_code_(rate_code(settings.rate_hz)) {}

  [[nodiscard]] std::string title() const override { return device_->title(); }
  [[nodiscard]] Result<void> configure() override;
  [[nodiscard]] SensorDuration nominal_period() const override {
    return duration_from_seconds(1 / kRates_hz.at(rate_code_ - 1U));
  }
  [[nodiscard]] Result<FifoLevel> fifo_level() override;
  [[nodiscard]] Result<std::vector<std::optional<ChipReading>>> read_fifo(
      std::size_t samples) override;
  [[nodiscard]] Result<void> restart_fifo() override;
  [[nodiscard]] Result<ChipReading> read_latest() override;

 private:
  [[nodiscard]] Result<void> read_words(std::vector<std::uint8_t>& bytes);
  [[nodiscard]] Eigen::Vector3d gyro(const std::uint8_t* bytes) const;
  [[nodiscard]] Eigen::Vector3d accel(const std::uint8_t* bytes) const;

  std::unique_ptr<I2cDevice> device_;
  I2cImuSettings settings_;
  std::uint8_t rate_code_;
};

Result<void> Lsm6dso::configure() {
  if (const auto name = identify(*device_, kFamily); !name) return tl::unexpected(name.error());
  if (auto done = device_->write(kControl3, kControl3Reset); !done) return done;
  std::this_thread::sleep_for(milliseconds(10));
  const auto rate = static_cast<std::uint8_t>(rate_code_ << 4U);
  const auto gyro_range = settings_.gyro_range == GyroRange::dps_2000 ? 0x0C : 0x08;
  const auto accel_range = settings_.accel_range == AccelRange::g_16 ? 0x04 : 0x0C;
  const std::array<RegisterValue, 6> values{
      {{kControl3, kControl3Normal},
       {kPulsedReady, kPulsedReadyOn},
       {kInterrupt1, kInterrupt1Gyro},
       {kFifoMode, kFifoBypass},
       {kAccelControl, static_cast<std::uint8_t>(rate | accel_range)},
       {kGyroControl, static_cast<std::uint8_t>(rate | gyro_range)}}};
  if (auto done = device_->write_all(values); !done) return done;
  // Until both run the FIFO is off, so that gyroscope and accelerometer come in pairs.
  std::this_thread::sleep_for(milliseconds(100));
  return {};
}

Result<FifoLevel> Lsm6dso::fifo_level() {
  std::array<std::uint8_t, 2> status{};
  if (auto got = device_->read(kFifoStatus, status); !got) return tl::unexpected(got.error());
  const auto words = static_cast<std::size_t>((status[1] & kStatus2Count) << 8 | status[0]);
  return FifoLevel{.samples = words / 2, .has_overflowed = (status[1] & kStatus2Overrun) != 0};
}

/// Each sample is two words, in either order, of which the tag says what they are.
Result<std::vector<std::optional<ChipReading>>> Lsm6dso::read_fifo(std::size_t samples) {
  std::vector<std::uint8_t> bytes(samples * 2 * kWord);
  if (auto got = read_words(bytes); !got) return tl::unexpected(got.error());
  std::vector<std::optional<ChipReading>> readings;
  for (std::size_t i = 0; i < samples; ++i) {
    const std::uint8_t* first = &bytes[2 * i * kWord];
    const std::uint8_t* second = first + kWord;
    if (first[0] >> 3 == kTagAccel) std::swap(first, second);
    const bool is_pair = first[0] >> 3 == kTagGyro && second[0] >> 3 == kTagAccel &&
                         (first[0] & kTagCount) == (second[0] & kTagCount);
    if (!is_pair) return failed(title() + ": gyroscope and accelerometer come not in pairs");
    readings.emplace_back(ChipReading{gyro(first + 1), accel(second + 1)});
  }
  return readings;
}

Result<void> Lsm6dso::read_words(std::vector<std::uint8_t>& bytes) {
  const std::size_t chunk = device_->longest_read() / kWord * kWord;
  for (std::size_t at = 0; at < bytes.size(); at += chunk) {
    const auto part = std::span(bytes).subspan(at, std::min(chunk, bytes.size() - at));
    if (auto got = device_->read_once(kFifoPort, part); !got) return got;
  }
  return {};
}

Result<void> Lsm6dso::restart_fifo() {
  const auto rates = static_cast<std::uint8_t>(rate_code_ << 4U | rate_code_);
  const std::array<RegisterValue, 3> values{
      {{kFifoMode, kFifoBypass}, {kFifoRates, rates}, {kFifoMode, kFifoContinuous}}};
  return device_->write_all(values);
}

Result<ChipReading> Lsm6dso::read_latest() {
  std::array<std::uint8_t, 12> bytes{};
  if (auto got = device_->read(kData, bytes); !got) return tl::unexpected(got.error());
  return ChipReading{gyro(bytes.data()), accel(&bytes[6])};
}

/// The data sheet's sensitivity is 70 mdps a bit at 2000 dps, which is not 2000/32768.
Eigen::Vector3d Lsm6dso::gyro(const std::uint8_t* bytes) const {
  const double dps = settings_.gyro_range == GyroRange::dps_2000 ? 0.070 : 0.035;
  return little_endian_axes(bytes) * (dps * kRadiansPerDegree);
}

/// 0.488 mg a bit at 16 g.
Eigen::Vector3d Lsm6dso::accel(const std::uint8_t* bytes) const {
  const double g = settings_.accel_range == AccelRange::g_16 ? 0.488e-3 : 0.244e-3;
  return little_endian_axes(bytes) * (g * kStandardGravity_m_s2);
}

}  // namespace

std::unique_ptr<ImuChip> make_lsm6dso(std::unique_ptr<I2cDevice> device,
                                      const I2cImuSettings& settings) {
  return std::make_unique<Lsm6dso>(std::move(device), settings);
}

Result<std::unique_ptr<ImuSource>> open_i2c_lsm6dso(const I2cImuSettings& settings,
                                                    std::unique_ptr<EdgeSource> data_ready) {
  return open_chip(kFamily, make_lsm6dso, settings, std::move(data_ready));
}

std::vector<DeviceReport> list_i2c_lsm6dso() {
  return probe_buses(kFamily);
}

}  // namespace gimbal
