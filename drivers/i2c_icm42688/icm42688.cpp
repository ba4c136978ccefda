#include "drivers/i2c_icm42688/icm42688.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>
#include <utility>

#include "drivers/i2c/open_chip.hpp"
#include "drivers/i2c/probe.hpp"
#include "drivers/i2c_icm42688/icm42688_registers.hpp"

namespace gimbal {
namespace {

using namespace icm42688;  // NOLINT(google-build-using-namespace): register names
using std::chrono::milliseconds;

constexpr std::array kMembers{ChipIdentity{0x47, "ICM-42688-P"}};
constexpr std::array<std::uint8_t, 2> kAddresses{0x68, 0x69};
constexpr ChipFamily kFamily{"i2c_icm42688", kIdentity, kMembers, kAddresses};

struct Rate {
  double hz;
  std::uint8_t code;  ///< GYRO_ODR and ACCEL_ODR
};
constexpr std::array kRates{Rate{50, 9},   Rate{100, 8},  Rate{200, 7},
                            Rate{500, 15}, Rate{1000, 6}, Rate{2000, 5}};

/// Header, accelerometer, gyroscope, temperature, time: "packet 3".
constexpr std::size_t kPacket = 16;
constexpr std::size_t kMostPackets = 128;  // in 2 KiB
constexpr double kInvalid = -32768;

const Rate& choose_rate(double wish_hz) {
  const auto* rate = std::find_if(kRates.begin(), kRates.end(),
                                  [&](const Rate& it) { return it.hz >= 0.99 * wish_hz; });
  return rate != kRates.end() ? *rate : kRates.back();
}

class Icm42688 final : public ImuChip {
 public:
  Icm42688(std::unique_ptr<I2cDevice> device, const I2cImuSettings& settings)
      : device_(std::move(device)), settings_(settings), rate_(choose_rate(settings.rate_hz)) {}

  [[nodiscard]] std::string title() const override { return device_->title(); }
  [[nodiscard]] Result<void> configure() override;
  [[nodiscard]] SensorDuration nominal_period() const override {
    return duration_from_seconds(1 / rate_.hz);
  }
  [[nodiscard]] Result<FifoLevel> fifo_level() override;
  [[nodiscard]] Result<std::vector<std::optional<ChipReading>>> read_fifo(
      std::size_t samples) override;
  [[nodiscard]] Result<void> restart_fifo() override;
  [[nodiscard]] Result<ChipReading> read_latest() override;

 private:
  std::unique_ptr<I2cDevice> device_;
  I2cImuSettings settings_;
  Rate rate_;
};

Result<void> Icm42688::configure() {
  if (auto done = device_->write(kBank, 0); !done) return done;
  if (const auto name = identify(*device_, kFamily); !name) return tl::unexpected(name.error());
  if (auto done = device_->write(kReset, kResetNow); !done) return done;
  std::this_thread::sleep_for(milliseconds(2));
  const auto gyro = settings_.gyro_range == GyroRange::dps_2000 ? 0x00 : 0x20;
  const auto accel = settings_.accel_range == AccelRange::g_16 ? 0x00 : 0x20;
  const std::array<RegisterValue, 7> values{
      {{kInterface0, kInterface0Records},
       {kInterruptPin, kPinPulsed},
       {kInterruptConfig1, 0},  // INT_ASYNC_RESET must be cleared, says the data sheet
       {kInterruptSource, kSourceDataReady},
       {kGyroConfig, static_cast<std::uint8_t>(gyro | rate_.code)},
       {kAccelConfig, static_cast<std::uint8_t>(accel | rate_.code)},
       {kPower, kPowerLowNoise}}};
  if (auto done = device_->write_all(values); !done) return done;
  std::this_thread::sleep_for(milliseconds(50));  // gyroscope start-up, and no writes meanwhile
  return {};
}

Result<FifoLevel> Icm42688::fifo_level() {
  std::array<std::uint8_t, 2> count{};
  if (auto got = device_->read(kFifoCount, count); !got) return tl::unexpected(got.error());
  const auto packets = static_cast<std::size_t>(count[0] << 8 | count[1]);
  return FifoLevel{.samples = packets, .has_overflowed = packets >= kMostPackets};
}

Result<std::vector<std::optional<ChipReading>>> Icm42688::read_fifo(std::size_t samples) {
  std::vector<std::uint8_t> bytes(samples * kPacket);
  const std::size_t chunk = device_->longest_read() / kPacket * kPacket;
  for (std::size_t at = 0; at < bytes.size(); at += chunk) {
    const auto part = std::span(bytes).subspan(at, std::min(chunk, bytes.size() - at));
    if (auto got = device_->read_once(kFifoPort, part); !got) return tl::unexpected(got.error());
  }
  std::vector<std::optional<ChipReading>> readings;
  for (std::size_t i = 0; i < samples; ++i) {
    const std::uint8_t* packet = &bytes[i * kPacket];
    const bool is_expected = (packet[0] & (kHeaderEmpty | kHeaderKinds)) == kHeaderGyroAccel;
    if (!is_expected) return failed(title() + ": a packet of the FIFO has an unknown header");
    const bool is_valid = (big_endian_axes(packet + 7).array() != kInvalid).all();
    readings.push_back(is_valid
                           ? std::optional(full_scale_reading(settings_, packet + 1, packet + 7))
                           : std::nullopt);
  }
  return readings;
}

Result<void> Icm42688::restart_fifo() {
  const std::array<RegisterValue, 4> values{{{kFifoMode, kFifoBypass},
                                             {kSignalPath, kSignalPathFlush},
                                             {kFifoSources, kFifoPackets},
                                             {kFifoMode, kFifoStream}}};
  return device_->write_all(values);
}

Result<ChipReading> Icm42688::read_latest() {
  std::array<std::uint8_t, 12> bytes{};
  if (auto got = device_->read(kData, bytes); !got) return tl::unexpected(got.error());
  return full_scale_reading(settings_, bytes.data(), &bytes[6]);
}

}  // namespace

std::unique_ptr<ImuChip> make_icm42688(std::unique_ptr<I2cDevice> device,
                                       const I2cImuSettings& settings) {
  return std::make_unique<Icm42688>(std::move(device), settings);
}

Result<std::unique_ptr<ImuSource>> open_i2c_icm42688(const I2cImuSettings& settings,
                                                     std::unique_ptr<EdgeSource> data_ready) {
  return open_chip(kFamily, make_icm42688, settings, std::move(data_ready));
}

std::vector<DeviceReport> list_i2c_icm42688() {
  return probe_buses(kFamily);
}

}  // namespace gimbal
