#pragma once

#include <string>
#include <string_view>

namespace gimbal {

/// A value as GStreamer's pipeline notation takes it, whatever letters are in it.
[[nodiscard]] inline std::string in_pipeline_quotes(std::string_view value) {
  std::string quoted = "\"";
  for (const char letter : value) {
    if (letter == '"' || letter == '\\') quoted += '\\';
    quoted += letter;
  }
  return quoted + '"';
}

}  // namespace gimbal
