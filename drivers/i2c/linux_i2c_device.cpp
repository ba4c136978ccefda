#include <fcntl.h>
#include <fmt/format.h>
#include <grp.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "drivers/i2c/i2c_device.hpp"

namespace gimbal {
namespace {

/// Linux's i2c-dev takes 8192 bytes a message; smaller adapters' limits are near this.
constexpr std::size_t kLongestCombinedRead = 256;

class FileDescriptor {
 public:
  explicit FileDescriptor(int fd) : fd_(fd) {}
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&&) = delete;
  ~FileDescriptor() {
    if (fd_ >= 0) close(fd_);
  }
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

/// Messages to the chip and back without letting go of the bus.
class CombinedDevice final : public I2cDevice {
 public:
  CombinedDevice(const I2cAddress& address, FileDescriptor file)
      : I2cDevice(to_string(address)), chip_(address.chip), file_(std::move(file)) {}

  [[nodiscard]] std::size_t longest_read() const override { return kLongestCombinedRead; }

 protected:
  [[nodiscard]] int transfer_write(std::uint8_t first_register, std::uint8_t value) override {
    std::array<std::uint8_t, 2> bytes{first_register, value};
    std::array messages{
        i2c_msg{.addr = chip_, .flags = 0, .len = bytes.size(), .buf = bytes.data()}};
    return transfer(messages);
  }

  [[nodiscard]] int transfer_read(std::uint8_t first_register,
                                  std::span<std::uint8_t> values) override {
    std::array messages{i2c_msg{.addr = chip_, .flags = 0, .len = 1, .buf = &first_register},
                        i2c_msg{.addr = chip_,
                                .flags = I2C_M_RD,
                                .len = static_cast<std::uint16_t>(values.size()),
                                .buf = values.data()}};
    return transfer(messages);
  }

 private:
  [[nodiscard]] int transfer(std::span<i2c_msg> messages) const {
    i2c_rdwr_ioctl_data data{.msgs = messages.data(),
                             .nmsgs = static_cast<std::uint32_t>(messages.size())};
    return ioctl(file_.get(), I2C_RDWR, &data) < 0 ? errno : 0;
  }

  std::uint16_t chip_;
  FileDescriptor file_;
};

/// For adapters that know SMBus alone, and for the kernel's i2c-stub.
class SmbusDevice final : public I2cDevice {
 public:
  SmbusDevice(const I2cAddress& address, FileDescriptor file)
      : I2cDevice(to_string(address)), file_(std::move(file)) {}

  [[nodiscard]] std::size_t longest_read() const override { return I2C_SMBUS_BLOCK_MAX; }

 protected:
  [[nodiscard]] int transfer_write(std::uint8_t first_register, std::uint8_t value) override {
    i2c_smbus_data data{};
    data.byte = value;
    return transfer(I2C_SMBUS_WRITE, first_register, I2C_SMBUS_BYTE_DATA, data);
  }

  [[nodiscard]] int transfer_read(std::uint8_t first_register,
                                  std::span<std::uint8_t> values) override {
    if (values.size() > longest_read()) return EMSGSIZE;
    i2c_smbus_data data{};
    data.block[0] = static_cast<std::uint8_t>(values.size());
    const int failure = transfer(I2C_SMBUS_READ, first_register, I2C_SMBUS_I2C_BLOCK_DATA, data);
    if (failure != 0) return failure;
    if (data.block[0] != values.size()) return EIO;
    std::copy_n(&data.block[1], values.size(), values.begin());
    return 0;
  }

 private:
  [[nodiscard]] int transfer(std::uint8_t direction, std::uint8_t command, std::uint32_t size,
                             i2c_smbus_data& data) const {
    i2c_smbus_ioctl_data request{
        .read_write = direction, .command = command, .size = size, .data = &data};
    return ioctl(file_.get(), I2C_SMBUS, &request) < 0 ? errno : 0;
  }

  FileDescriptor file_;
};

std::string group_of(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return "?";
  const group* entry = getgrgid(status.st_gid);
  return entry != nullptr ? entry->gr_name : std::to_string(status.st_gid);
}

tl::unexpected<Error> open_error(const I2cAddress& address, int error) {
  std::string why = std::strerror(error);
  if (error == EACCES) {
    why = fmt::format("no permission; join the group {} or run as root", group_of(address.bus));
  } else if (error == ENOENT) {
    why = "there is no such bus; load the module i2c-dev and enable the bus in the device tree";
  } else if (error == EBUSY) {
    why = "a kernel driver holds this chip; use the iio driver, or unbind it";
  }
  return bad_input(fmt::format("{}: {}", to_string(address), why));
}

}  // namespace

Result<std::unique_ptr<I2cDevice>> open_i2c_device(const I2cAddress& address) {
  FileDescriptor file(::open(address.bus.c_str(), O_RDWR | O_CLOEXEC));
  if (file.get() < 0) return open_error(address, errno);
  // I2C_RDWR alone would not notice that a kernel driver holds the chip.
  if (ioctl(file.get(), I2C_SLAVE, static_cast<unsigned long>(address.chip)) < 0) {
    return open_error(address, errno);
  }
  unsigned long functions = 0;
  if (ioctl(file.get(), I2C_FUNCS, &functions) < 0) return open_error(address, errno);
  if ((functions & I2C_FUNC_I2C) != 0) {
    return std::make_unique<CombinedDevice>(address, std::move(file));
  }
  constexpr unsigned long kNeeded = I2C_FUNC_SMBUS_WRITE_BYTE_DATA | I2C_FUNC_SMBUS_READ_I2C_BLOCK;
  if ((functions & kNeeded) != kNeeded) {
    return bad_input(
        fmt::format("{}: the bus's adapter can read no blocks of registers", to_string(address)));
  }
  return std::make_unique<SmbusDevice>(address, std::move(file));
}

}  // namespace gimbal
