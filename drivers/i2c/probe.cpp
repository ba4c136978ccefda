#include "drivers/i2c/probe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace gimbal {
namespace {

std::vector<std::string> find_buses() {
  std::vector<std::string> buses;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", error)) {
    if (entry.path().string().starts_with("/dev/i2c-")) buses.push_back(entry.path().string());
  }
  std::sort(buses.begin(), buses.end());
  return buses;
}

std::string expected(const ChipFamily& family) {
  std::string text;
  for (const ChipIdentity& member : family.members) {
    text += fmt::format("{}{:#04x} ({})", text.empty() ? "" : ", ", member.value, member.name);
  }
  return text;
}

}  // namespace

Result<std::string> identify(I2cDevice& device, const ChipFamily& family) {
  const auto value = device.read_byte(family.identity_register);
  if (!value) return tl::unexpected(value.error());
  for (const ChipIdentity& member : family.members) {
    if (member.value == *value) return member.name;
  }
  return bad_input(
      fmt::format("{}: another chip answers: register {:#04x} reads {:#04x}, expected {}",
                  device.title(), family.identity_register, *value, expected(family)));
}

std::vector<DeviceReport> probe_buses(const ChipFamily& family) {
  std::vector<DeviceReport> reports;
  for (const std::string& bus : find_buses()) {
    for (const std::uint8_t chip : family.addresses) {
      const I2cAddress address{bus, chip};
      DeviceReport report{.driver = family.driver,
                          .address = to_string(address),
                          .name = {},
                          .details = {},
                          .obstacle = {}};
      const auto device = open_i2c_device(address);
      if (!device) {
        report.obstacle = device.error().message;
        reports.push_back(report);
        continue;
      }
      const auto name = identify(**device, family);
      if (!name) continue;  // nobody there, or another chip
      report.name = *name;
      reports.push_back(report);
    }
  }
  return reports;
}

}  // namespace gimbal
