#include <fmt/format.h>

#include <optional>
#include <string>

#include "drivers/iio/iio_imu.hpp"
#include "drivers/iio/libiio.hpp"
#include "drivers/iio/sampling_frequency.hpp"
#include "drivers/iio/trigger.hpp"

namespace gimbal {
namespace {

/// Below this a rolling shutter's readout holds hardly a sample.
constexpr double kUsefulRate_hz = 100;

std::string kinds_of(const IioCandidate& candidate) {
  if (candidate.has_gyro && candidate.has_accel) return "gyroscope and accelerometer";
  return candidate.has_gyro ? "gyroscope" : "accelerometer";
}

const iio_channel& axis_of(const iio_device& device, const IioCandidate& candidate) {
  return *find_axis(device, candidate.has_gyro ? IioTriad::gyro : IioTriad::accel, 0);
}

std::string trigger_line(TriggerState state) {
  switch (state) {
    case TriggerState::not_needed:
      return "samples by itself";
    case TriggerState::set:
      return "has a trigger";
    case TriggerState::own:
      return "its own trigger will be set";
    case TriggerState::timer:
      return "a trigger by a timer will be made";
    case TriggerState::impossible:
      return "has no trigger";
  }
  return {};
}

std::string rate_obstacle(const std::optional<std::string>& available) {
  const auto highest = highest_frequency(available.value_or(""));
  if (!highest || *highest >= kUsefulRate_hz) return {};
  return fmt::format("samples at {:g} Hz at most; {:g} are needed", *highest, kUsefulRate_hz);
}

DeviceReport report_on(const iio_device& device, const IioCandidate& candidate) {
  DeviceReport report{.driver = "iio",
                      .address = candidate.id,
                      .name = candidate.name.empty() ? candidate.label : candidate.name,
                      .details = {kinds_of(candidate)},
                      .obstacle = candidate.obstacle};
  const iio_channel& axis = axis_of(device, candidate);
  const auto rate = read_attribute(axis, "sampling_frequency");
  if (rate) report.details.push_back("now at " + *rate + " Hz");
  const auto available = read_attribute(axis, "sampling_frequency_available");
  if (available) report.details.push_back("rates: " + *available + " Hz");
  if (!report.obstacle.empty()) return report;

  const TriggerState trigger = trigger_state({}, candidate.id);
  report.details.push_back(trigger_line(trigger));
  if (trigger == TriggerState::impossible) {
    report.obstacle =
        "has no trigger, and none may be made; load the module iio-trig-hrtimer and run as root, "
        "or "
        "set current_trigger";
  } else {
    report.obstacle = rate_obstacle(available);
  }
  return report;
}

}  // namespace

std::vector<DeviceReport> list_iio_imus() {
  std::vector<DeviceReport> reports;
  const auto context = scan_iio_devices();
  if (!context) return reports;
  for (const IioCandidate& candidate : find_candidates(**context)) {
    const iio_device* device = iio_context_find_device(context->get(), candidate.id.c_str());
    reports.push_back(report_on(*device, candidate));
  }
  return reports;
}

}  // namespace gimbal
