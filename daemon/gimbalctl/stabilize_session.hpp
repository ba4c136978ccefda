#pragma once

#include <filesystem>
#include <string>

#include "daemon/gimbalctl/progress_bar.hpp"
#include "daemon/stabilization.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// What the command line asks for.
struct StabilizeRequest : StabilizationSettings {
  std::filesystem::path session;
  std::string out;
  std::filesystem::path path_log;  ///< empty: none
  std::filesystem::path report;    ///< empty: none
  ProgressStyle progress = ProgressStyle::automatic;
};

/// Reads a recording, writes it steady. Warnings go to standard error.
[[nodiscard]] Result<void> stabilize_session(const StabilizeRequest& request);

}  // namespace gimbal
