#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gimbal {

/// Syslog's levels that are in use, by their numbers.
enum class LogLevel : std::uint8_t { error = 3, warning = 4, info = 6 };

/// Whom a line is about, for those who search the journal; either may be empty.
struct LogSubject {
  std::string_view part;  ///< "camera", "imu", "output", "recording", "renderer", ...
  std::string_view name;  ///< which of several
};

/// A line on standard error; in systemd's journal, where that is what standard error is, an entry
/// with the fields of journal_fields(). The same line again and again is held back. Any thread may
/// call it.
void log_line(LogLevel level, std::string_view text, LogSubject subject = {});

/// "NAME=value" each (systemd.journal-fields(7)): MESSAGE and PRIORITY; GIMBALD_PART, GIMBALD_NAME
/// and GIMBALD_HELD_BACK, how many such lines were held back before, where there is something to
/// say.
[[nodiscard]] std::vector<std::string> journal_fields(LogLevel level, std::string_view text,
                                                      LogSubject subject, std::uint64_t held_back);

}  // namespace gimbal
