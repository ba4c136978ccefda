#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>

#include "drivers/gpio/gpio_edges.hpp"

namespace gimbal {
namespace {

DeviceReport report_on(const std::string& path) {
  DeviceReport report{.driver = "gpio", .address = path, .name = {}, .details = {}, .obstacle = {}};
  const auto chip = read_gpio_chip(path);
  if (!chip) {
    report.obstacle = chip.error().message;
    return report;
  }
  report.name = chip->label;
  report.details = chip->named_lines;
  report.details.insert(report.details.begin(), fmt::format("{} lines", chip->lines));
  return report;
}

}  // namespace

std::vector<DeviceReport> list_gpio_chips() {
  std::vector<DeviceReport> reports;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", error)) {
    const std::string path = entry.path().string();
    if (path.starts_with("/dev/gpiochip")) reports.push_back(report_on(path));
  }
  std::sort(reports.begin(), reports.end(),
            [](const auto& a, const auto& b) { return a.address < b.address; });
  return reports;
}

}  // namespace gimbal
