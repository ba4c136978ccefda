#include <fmt/format.h>

#include <string_view>
#include <vector>

#include "daemon/gimbalctl/commands.hpp"
#include "drivers/driver_table.hpp"

namespace gimbal {
namespace {

void print_report(const DeviceReport& report) {
  fmt::print("{}  {}  {}\n", report.driver, report.address, report.name);
  for (const std::string& detail : report.details) fmt::print("    {}\n", detail);
  if (!report.obstacle.empty()) fmt::print("    cannot be used: {}\n", report.obstacle);
}

void print_devices() {
  const std::vector<DeviceReport> devices = list_devices();
  for (const DeviceReport& device : devices) print_report(device);
  if (devices.empty()) {
    fmt::print(
        "No camera, IMU or GPIO chip was found. Is it plugged in, and does dmesg tell of it?\n");
  }
  for (const std::string_view driver : drivers_left_out()) {
    fmt::print("The driver {} was left out when this program was built.\n", driver);
  }
}

}  // namespace

void add_devices_command(CLI::App& app, CommandOutcome&) {
  CLI::App* command = app.add_subcommand(
      "devices", "List cameras, IMUs and GPIO chips, and why one cannot be used");
  command->callback(print_devices);
}

}  // namespace gimbal
