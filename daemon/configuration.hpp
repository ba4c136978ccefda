#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "daemon/stabilization.hpp"
#include "drivers/replay/paced_replay.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// A recording that plays the part of camera and IMU.
struct ReplaySettings {
  std::filesystem::path session;
  Repeat repeat = Repeat::forever;
};

/// What the daemon is told to do. See config/examples.
struct Configuration {
  ReplaySettings replay;
  StabilizationSettings stabilization;
  std::vector<std::string> outputs;  ///< as `gimbalctl stabilize -o` takes them
};

/// Reads the files in order; a later one overrides single keys of an earlier one. Fails with file,
/// line, key, what was found and what is allowed; a key that is not known is an error.
[[nodiscard]] Result<Configuration> load_configuration(
    std::span<const std::filesystem::path> files);

}  // namespace gimbal
