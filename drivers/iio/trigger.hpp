#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Where the kernel shows IIO devices and lets triggers be made (kernel: Documentation/iio/
/// iio_configfs.rst).
struct IioFolders {
  std::filesystem::path devices = "/sys/bus/iio/devices";
  std::filesystem::path timer_triggers = "/sys/kernel/config/iio/triggers/hrtimer";
};

/// What an IIO device needs so that samples begin to flow into its buffer.
enum class TriggerState : std::uint8_t {
  not_needed,  ///< the device fills its buffer by itself
  set,
  own,    ///< none is set, but the device has one of its own
  timer,  ///< none is set, but one by a timer can be made
  impossible,
};

[[nodiscard]] TriggerState trigger_state(const IioFolders& folders, const std::string& device_id);

/// Lets `device_id` ("iio:device0") sample by the trigger called `wanted`; if that is empty by the
/// one that is set, else by its own, else by a timer's that is made for it. A trigger that has a
/// rate is set to `rate_hz`. Nothing to do for a device without triggers.
[[nodiscard]] Result<void> prepare_trigger(const IioFolders& folders, const std::string& device_id,
                                           const std::string& wanted, double rate_hz);

}  // namespace gimbal
