#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

namespace gimbal {

/// How the gyroscope's bias is kept from one run to the next.
struct BiasMemorySettings {
  /// Empty: it is not. None: where a device's is kept, while a recording's is not.
  std::optional<std::filesystem::path> file;
  /// What is older counts for nothing.
  std::chrono::seconds longest_age = std::chrono::hours(30 * 24);

  bool operator==(const BiasMemorySettings&) const = default;
};

}  // namespace gimbal
