#include "drivers/i2c/i2c_device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <thread>

namespace gimbal {
namespace {

constexpr int kTries = 4;
constexpr std::chrono::microseconds kPauseBetweenTries(300);

/// No acknowledge, arbitration lost, a stretched clock: what another try may mend.
bool is_passing(int error_number) {
  static constexpr std::array kPassing{EREMOTEIO, ENXIO, EAGAIN, ETIMEDOUT, EIO, EBUSY, EINTR};
  return std::find(kPassing.begin(), kPassing.end(), error_number) != kPassing.end();
}

template <typename Transfer>
int try_some_times(Transfer transfer) {
  int error_number = 0;
  for (int i = 0; i < kTries; ++i) {
    if (i > 0) std::this_thread::sleep_for(kPauseBetweenTries);
    error_number = transfer();
    if (!is_passing(error_number)) break;
  }
  return error_number;
}

}  // namespace

std::string to_string(const I2cAddress& address) {
  return fmt::format("{}:{:#04x}", address.bus, address.chip);
}

Result<I2cAddress> parse_i2c_address(const std::string& text) {
  constexpr int kHighest = 0x77;  // the last that is not reserved
  const auto colon = text.rfind(":0x");
  if (colon != std::string::npos && colon > 0) {
    int chip = 0;
    const char* end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data() + colon + 3, end, chip, 16);
    if (parsed.ec == std::errc() && parsed.ptr == end && chip > 0 && chip <= kHighest) {
      return I2cAddress{text.substr(0, colon), static_cast<std::uint8_t>(chip)};
    }
  }
  return bad_input(fmt::format("I²C address \"{}\" is not of the form /dev/i2c-1:0x68", text));
}

Result<void> I2cDevice::write(std::uint8_t first_register, std::uint8_t value) {
  const int failure = try_some_times([&] { return transfer_write(first_register, value); });
  if (failure != 0) return tl::unexpected(error("write", first_register, failure));
  return {};
}

Result<void> I2cDevice::write_all(std::span<const RegisterValue> values) {
  for (const RegisterValue& one : values) {
    if (auto done = write(one.at, one.value); !done) return done;
  }
  return {};
}

Result<void> I2cDevice::read(std::uint8_t first_register, std::span<std::uint8_t> values) {
  const int failure = try_some_times([&] { return transfer_read(first_register, values); });
  if (failure != 0) return tl::unexpected(error("read", first_register, failure));
  return {};
}

Result<std::uint8_t> I2cDevice::read_byte(std::uint8_t first_register) {
  std::uint8_t value = 0;
  if (auto got = read(first_register, {&value, 1}); !got) return tl::unexpected(got.error());
  return value;
}

Result<void> I2cDevice::read_once(std::uint8_t port, std::span<std::uint8_t> values) {
  const int failure = transfer_read(port, values);
  if (failure != 0) return tl::unexpected(error("read", port, failure));
  return {};
}

Error I2cDevice::error(const char* what, std::uint8_t first_register, int error_number) const {
  return {Error::Kind::failed, fmt::format("{}: cannot {} register {:#04x}: {}", title_, what,
                                           first_register, std::strerror(error_number))};
}

}  // namespace gimbal
