#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Where a chip is: the bus's device file and the chip's 7-bit address.
struct I2cAddress {
  std::string bus = "/dev/i2c-1";
  std::uint8_t chip = 0;

  bool operator==(const I2cAddress&) const = default;
};

/// "/dev/i2c-1:0x68"
[[nodiscard]] std::string to_string(const I2cAddress& address);

/// Reads "/dev/i2c-1:0x68".
[[nodiscard]] Result<I2cAddress> parse_i2c_address(const std::string& text);

/// What is to be written where.
struct RegisterValue {
  std::uint8_t at;
  std::uint8_t value;
};

/// The registers of a chip on an I²C bus. What a disturbed bus refuses is tried again a few times;
/// what then still fails is an error.
class I2cDevice {
 public:
  explicit I2cDevice(std::string title) : title_(std::move(title)) {}
  I2cDevice(const I2cDevice&) = delete;
  I2cDevice& operator=(const I2cDevice&) = delete;
  virtual ~I2cDevice() = default;

  [[nodiscard]] const std::string& title() const { return title_; }

  [[nodiscard]] Result<void> write(std::uint8_t first_register, std::uint8_t value);
  /// One after the other; ends at the first that fails.
  [[nodiscard]] Result<void> write_all(std::span<const RegisterValue> values);
  [[nodiscard]] Result<void> read(std::uint8_t first_register, std::span<std::uint8_t> values);
  [[nodiscard]] Result<std::uint8_t> read_byte(std::uint8_t first_register);

  /// From a FIFO's port: not tried again, because a chip has given away what was lost underway.
  [[nodiscard]] Result<void> read_once(std::uint8_t port, std::span<std::uint8_t> values);

  /// Bytes that one read can have.
  [[nodiscard]] virtual std::size_t longest_read() const = 0;

 protected:
  /// One transfer; 0 or an errno.
  [[nodiscard]] virtual int transfer_write(std::uint8_t first_register, std::uint8_t value) = 0;
  [[nodiscard]] virtual int transfer_read(std::uint8_t first_register,
                                          std::span<std::uint8_t> values) = 0;

 private:
  [[nodiscard]] Error error(const char* what, std::uint8_t first_register, int error_number) const;

  std::string title_;
};

/// By Linux's i2c-dev: combined transfers, or SMBus I²C blocks where the adapter has no others.
/// Refuses a chip that a kernel driver holds.
[[nodiscard]] Result<std::unique_ptr<I2cDevice>> open_i2c_device(const I2cAddress& address);

}  // namespace gimbal
