#pragma once

#include <fmt/chrono.h>

#include <ctime>
#include <string>

namespace gimbal {

/// What is begun now, as a file's name in local time: sorted by name is sorted by time.
[[nodiscard]] inline std::string name_now() {
  return fmt::format("{:%Y-%m-%dT%H-%M-%S}", fmt::localtime(std::time(nullptr)));
}

}  // namespace gimbal
