#include <fmt/format.h>
#include <grp.h>
#include <sys/stat.h>

#include <cerrno>
#include <charconv>
#include <cstring>

#include "drivers/gpio/gpio_lines.hpp"

namespace gimbal {
namespace {

std::string group_of(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return "?";
  const group* entry = getgrgid(status.st_gid);
  return entry != nullptr ? entry->gr_name : std::to_string(status.st_gid);
}

}  // namespace

std::string to_string(const GpioAddress& address) {
  return fmt::format("{}:{}", address.chip, address.line);
}

Result<GpioAddress> parse_gpio_address(const std::string& text) {
  const auto colon = text.rfind(':');
  GpioAddress address;
  if (colon != std::string::npos && colon > 0) {
    address.chip = text.substr(0, colon);
    const char* end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data() + colon + 1, end, address.line);
    if (parsed.ec == std::errc() && parsed.ptr == end) return address;
  }
  return bad_input(fmt::format("gpio line \"{}\" is not of the form gpiochip0:17", text));
}

std::string gpio_chip_path(const std::string& chip) {
  return chip.starts_with('/') ? chip : "/dev/" + chip;
}

std::string gpio_chip_obstacle(const std::string& path, int error) {
  switch (error) {
    case EACCES:
    case EPERM:
      return fmt::format("no permission on {}; join the group {} or run as root", path,
                         group_of(path));
    case EISDIR:
    case ENODEV:
    case ENOENT:
    case ENOTTY:
      return fmt::format("{} is no GPIO chip; `gimbalctl devices` lists those that are there",
                         path);
    default:
      return std::strerror(error);
  }
}

std::string gpio_line_obstacle(int error) {
  switch (error) {
    case EBUSY:
      return "another program or a kernel driver holds the line; `gpioinfo` says which";
    case EINVAL:
      return "there is no such line, or it cannot be used so";
    case ENODEV:
    case ENXIO:  // of a request for edges where the chip has no interrupts
      return "the chip is gone, or it cannot watch edges";
    default:
      return std::strerror(error);
  }
}

}  // namespace gimbal
