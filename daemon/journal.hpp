#pragma once

#include <cstdint>
#include <string_view>

namespace gimbal {

/// Syslog's levels that are in use, by their numbers.
enum class LogLevel : std::uint8_t { error = 3, warning = 4, info = 6 };

/// A line on standard error; under systemd with the level in front, as the journal takes it
/// (sd-daemon(3)). Any thread may call it.
void log_line(LogLevel level, std::string_view text);

}  // namespace gimbal
