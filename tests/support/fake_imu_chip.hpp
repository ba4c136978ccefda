#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "drivers/clock/monotonic_now.hpp"
#include "drivers/i2c/i2c_device.hpp"

namespace gimbal::test {

/// Raw numbers of sample `k`, all axes different and some negative.
inline std::array<std::int16_t, 3> fake_gyro(std::uint64_t k) {
  const auto step = static_cast<std::int16_t>(k % 1000);
  return {static_cast<std::int16_t>(-300 - step), static_cast<std::int16_t>(step), 0x0123};
}
inline std::array<std::int16_t, 3> fake_accel(std::uint64_t k) {
  return {-2, static_cast<std::int16_t>(k % 100), 0x0801};
}

/// What a test does to a chip and its bus while a driver uses it.
struct FakeChipControl {
  std::atomic<int> refusals = 0;  ///< so many transfers are not acknowledged
  std::atomic<bool> is_unplugged = false;
  std::atomic<bool> is_asleep = false;        ///< takes no samples any more
  std::atomic<std::uint64_t> flood = 0;       ///< so many samples come at once
  std::atomic<std::size_t> most_bytes = 256;  ///< of a read
  double period_s = 0.002;                    ///< of the chip's true rate
  std::array<std::uint8_t, 256> registers{};
  /// Samples since the FIFO began, if not by the clock.
  std::optional<std::uint64_t> produced = {};
};

/// A chip at the level of its registers: what is common to all.
class FakeImuChip : public I2cDevice {
 public:
  explicit FakeImuChip(std::shared_ptr<FakeChipControl> control)
      : I2cDevice("fake:0x68"), control_(std::move(control)) {}

  [[nodiscard]] std::size_t longest_read() const override { return control_->most_bytes; }

 protected:
  using Bytes = std::vector<std::uint8_t>;

  [[nodiscard]] int transfer_write(std::uint8_t at, std::uint8_t value) override {
    if (const int error = bus_error()) return error;
    control_->registers[at] = value;
    written(at, value);
    return 0;
  }

  [[nodiscard]] int transfer_read(std::uint8_t at, std::span<std::uint8_t> values) override {
    if (const int error = bus_error()) return error;
    if (values.size() > longest_read()) return EMSGSIZE;
    fill(at, values);
    return 0;
  }

  virtual void written(std::uint8_t at, std::uint8_t value) = 0;

  /// By default what is in the registers.
  virtual void fill(std::uint8_t at, std::span<std::uint8_t> values) {
    for (auto& value : values) value = control_->registers[at++];
  }

  /// Sample `k` as the FIFO holds it.
  [[nodiscard]] virtual Bytes frame(std::uint64_t k) const = 0;

  void begin_fifo() {
    began_ = monotonic_now();
    read_bytes_ = 0;
    control_->flood = 0;
  }

  [[nodiscard]] std::uint64_t produced() const {
    if (control_->is_asleep) return last_produced_;
    if (control_->produced) return *control_->produced;
    last_produced_ =
        control_->flood +
        static_cast<std::uint64_t>(to_seconds(monotonic_now() - began_) / control_->period_s);
    return last_produced_;
  }

  [[nodiscard]] std::uint64_t waiting_bytes() const {
    return produced() * frame(0).size() - read_bytes_;
  }

  void pop(std::span<std::uint8_t> values) {
    for (auto& value : values) {
      const auto bytes = frame(read_bytes_ / frame(0).size());
      value = bytes[read_bytes_ % bytes.size()];
      ++read_bytes_;
    }
  }

  static void append_big(Bytes& bytes, const std::array<std::int16_t, 3>& axes) {
    for (const auto axis : axes) {
      bytes.push_back(static_cast<std::uint8_t>(static_cast<unsigned>(axis) >> 8U));
      bytes.push_back(static_cast<std::uint8_t>(axis));
    }
  }

  static void append_little(Bytes& bytes, const std::array<std::int16_t, 3>& axes) {
    for (const auto axis : axes) {
      bytes.push_back(static_cast<std::uint8_t>(axis));
      bytes.push_back(static_cast<std::uint8_t>(static_cast<unsigned>(axis) >> 8U));
    }
  }

  std::shared_ptr<FakeChipControl> control_;

 private:
  [[nodiscard]] int bus_error() const {
    if (control_->is_unplugged) return EREMOTEIO;
    if (control_->refusals > 0) {
      --control_->refusals;
      return EREMOTEIO;
    }
    return 0;
  }

  SensorTime began_ = monotonic_now();
  std::uint64_t read_bytes_ = 0;
  mutable std::uint64_t last_produced_ = 0;
};

/// An MPU-6500, from its register map.
class FakeMpu6500 final : public FakeImuChip {
 public:
  explicit FakeMpu6500(std::shared_ptr<FakeChipControl> control) : FakeImuChip(std::move(control)) {
    control_->registers[0x75] = 0x70;
  }

 protected:
  void written(std::uint8_t at, std::uint8_t value) override {
    if (at == 0x23 && value == 0x78) begin_fifo();
  }
  void fill(std::uint8_t at, std::span<std::uint8_t> values) override {
    if (at == 0x74) return pop(values);
    if (at == 0x72) {
      const auto count = std::min<std::uint64_t>(waiting_bytes(), 512);
      control_->registers[0x72] = static_cast<std::uint8_t>(count >> 8U);
      control_->registers[0x73] = static_cast<std::uint8_t>(count);
    }
    FakeImuChip::fill(at, values);
  }
  [[nodiscard]] Bytes frame(std::uint64_t k) const override {
    Bytes bytes;
    append_big(bytes, fake_accel(k));
    append_big(bytes, fake_gyro(k));
    return bytes;
  }
};

/// An LSM6DSO, from its data sheet.
class FakeLsm6dso final : public FakeImuChip {
 public:
  explicit FakeLsm6dso(std::shared_ptr<FakeChipControl> control) : FakeImuChip(std::move(control)) {
    control_->registers[0x0F] = 0x6C;
  }

 protected:
  void written(std::uint8_t at, std::uint8_t value) override {
    if (at == 0x0A && value == 0x06) begin_fifo();
  }
  void fill(std::uint8_t at, std::span<std::uint8_t> values) override {
    if (at == 0x78) return pop(values);
    if (at == 0x3A) {
      const auto words = waiting_bytes() / 7;
      const bool is_over = words > 511;
      const auto count = is_over ? 511 : words;
      control_->registers[0x3A] = static_cast<std::uint8_t>(count);
      control_->registers[0x3B] = static_cast<std::uint8_t>(count >> 8U | (is_over ? 0x48U : 0U));
    }
    FakeImuChip::fill(at, values);
  }
  /// Gyroscope and accelerometer come in either order.
  [[nodiscard]] Bytes frame(std::uint64_t k) const override {
    const auto count = static_cast<unsigned>(k % 4) << 1U;
    Bytes gyro{static_cast<std::uint8_t>(0x01U << 3U | count)};
    append_little(gyro, fake_gyro(k));
    Bytes accel{static_cast<std::uint8_t>(0x02U << 3U | count)};
    append_little(accel, fake_accel(k));
    if (k % 2 == 1) std::swap(gyro, accel);
    gyro.insert(gyro.end(), accel.begin(), accel.end());
    return gyro;
  }
};

/// An ICM-42688-P, from its data sheet.
class FakeIcm42688 final : public FakeImuChip {
 public:
  explicit FakeIcm42688(std::shared_ptr<FakeChipControl> control)
      : FakeImuChip(std::move(control)) {
    control_->registers[0x75] = 0x47;
  }

 protected:
  void written(std::uint8_t at, std::uint8_t value) override {
    if (at == 0x16 && value == 0x40) begin_fifo();
  }
  void fill(std::uint8_t at, std::span<std::uint8_t> values) override {
    if (at == 0x30) return pop(values);
    if (at == 0x2E) {
      const auto packets = std::min<std::uint64_t>(waiting_bytes() / 16, 130);
      control_->registers[0x2E] = static_cast<std::uint8_t>(packets >> 8U);
      control_->registers[0x2F] = static_cast<std::uint8_t>(packets);
    }
    FakeImuChip::fill(at, values);
  }
  [[nodiscard]] Bytes frame(std::uint64_t k) const override {
    Bytes bytes{0x68};  // accelerometer, gyroscope, a time stamp
    append_big(bytes, fake_accel(k));
    append_big(bytes, fake_gyro(k));
    bytes.insert(bytes.end(), {25, 0, 0});
    return bytes;
  }
};

}  // namespace gimbal::test
