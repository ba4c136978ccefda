#pragma once

#include <nlohmann/json.hpp>

#include "daemon/supervisor.hpp"

namespace gimbal {

/// All that `gimbalctl status --json` shows: SI units, quaternions w first. States that are less
/// than they should be are named under `degraded`.
[[nodiscard]] nlohmann::ordered_json status_as_json(const Supervisor& daemon);

[[nodiscard]] nlohmann::ordered_json recording_as_json(const RecordingStatus& recording);

/// The settings that `set` takes, as it takes them.
[[nodiscard]] nlohmann::ordered_json live_settings_as_json(const StabilizationSettings& settings);

}  // namespace gimbal
