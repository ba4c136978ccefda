#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace gimbal {

/// The table [recording].
struct RecordingSettings {
  std::filesystem::path folder;      ///< of session folders; empty for sessions in state_folder
  std::string encoder;               ///< pipeline text; empty for the best that is installed
  std::uintmax_t min_free_mb = 100;  ///< less free space than that, and none is begun

  bool operator==(const RecordingSettings&) const = default;
};

}  // namespace gimbal
