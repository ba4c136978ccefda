#include "drivers/iio/trigger.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <system_error>

namespace gimbal {
namespace {

namespace fs = std::filesystem;

std::string read_line(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

Result<void> write_text(const fs::path& file, const std::string& text) {
  errno = 0;
  std::ofstream stream(file);
  stream << text << std::flush;
  if (stream) return {};
  return failed(
      fmt::format("cannot write \"{}\" to {}: {}", text, file.string(), std::strerror(errno)));
}

/// The folder of the trigger that is called so.
std::optional<fs::path> find_trigger(const IioFolders& folders, const std::string& name) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folders.devices, error)) {
    const bool is_trigger = entry.path().filename().string().starts_with("trigger");
    if (is_trigger && read_line(entry.path() / "name") == name) return entry.path();
  }
  return std::nullopt;
}

fs::path current_trigger_of(const IioFolders& folders, const std::string& device_id) {
  return folders.devices / device_id / "trigger" / "current_trigger";
}

std::string number_of(const std::string& device_id) {
  const auto digit = device_id.find_first_of("0123456789");
  return digit == std::string::npos ? device_id : device_id.substr(digit);
}

/// Drivers name their interrupt's trigger "NAME-devN".
std::string own_trigger_of(const IioFolders& folders, const std::string& device_id) {
  const std::string chip = read_line(folders.devices / device_id / "name");
  const std::string name = fmt::format("{}-dev{}", chip, number_of(device_id));
  return find_trigger(folders, name) ? name : std::string();
}

Result<std::string> make_timer_trigger(const IioFolders& folders, const std::string& device_id) {
  const std::string name = "gimbald-" + number_of(device_id);
  if (find_trigger(folders, name)) return name;
  if (!fs::exists(folders.timer_triggers)) {
    return failed(fmt::format(
        "{} has no trigger and {} is not there to make one; load the module iio-trig-hrtimer, or "
        "name a trigger",
        device_id, folders.timer_triggers.string()));
  }
  std::error_code error;
  fs::create_directory(folders.timer_triggers / name, error);
  if (error) {
    return failed(
        fmt::format("cannot make a trigger for {} in {}: {}; run as root, or set a trigger "
                    "before",
                    device_id, folders.timer_triggers.string(), error.message()));
  }
  return name;
}

/// The name of the trigger to use.
Result<std::string> choose_trigger(const IioFolders& folders, const std::string& device_id,
                                   const std::string& wanted) {
  if (!wanted.empty()) {
    if (find_trigger(folders, wanted)) return wanted;
    return bad_input(fmt::format("{}: there is no trigger \"{}\" in {}", device_id, wanted,
                                 folders.devices.string()));
  }
  if (auto own = own_trigger_of(folders, device_id); !own.empty()) return own;
  return make_timer_trigger(folders, device_id);
}

/// Interrupts' triggers have no rate of their own.
Result<void> set_rate(const IioFolders& folders, const std::string& trigger, double rate_hz) {
  const auto folder = find_trigger(folders, trigger);
  if (!folder) return {};
  const fs::path file = *folder / "sampling_frequency";
  if (!fs::exists(file)) return {};
  const std::string text = fmt::format("{:.3f}", rate_hz);
  if (std::abs(std::atof(read_line(file).c_str()) - rate_hz) < 1e-3) return {};
  return write_text(file, text);
}

}  // namespace

TriggerState trigger_state(const IioFolders& folders, const std::string& device_id) {
  const fs::path current = current_trigger_of(folders, device_id);
  if (!fs::exists(current)) return TriggerState::not_needed;
  if (!read_line(current).empty()) return TriggerState::set;
  if (!own_trigger_of(folders, device_id).empty()) return TriggerState::own;
  const bool may_make = access(folders.timer_triggers.c_str(), W_OK) == 0;
  return may_make ? TriggerState::timer : TriggerState::impossible;
}

Result<void> prepare_trigger(const IioFolders& folders, const std::string& device_id,
                             const std::string& wanted, double rate_hz) {
  const fs::path current = current_trigger_of(folders, device_id);
  if (!fs::exists(current)) return {};
  const std::string kept = read_line(current);
  if (!kept.empty() && (wanted.empty() || wanted == kept)) return set_rate(folders, kept, rate_hz);
  const auto trigger = choose_trigger(folders, device_id, wanted);
  if (!trigger) return tl::unexpected(trigger.error());
  if (auto set = set_rate(folders, *trigger, rate_hz); !set) return set;
  return write_text(current, *trigger);
}

}  // namespace gimbal
