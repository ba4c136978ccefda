#include "daemon/journal.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace gimbal {

void log_line(LogLevel level, std::string_view text) {
  static const bool is_journal = std::getenv("JOURNAL_STREAM") != nullptr;
  const std::string line = is_journal ? fmt::format("<{}>{}\n", static_cast<int>(level), text)
                                      : fmt::format("gimbald: {}\n", text);
  // One write, so that the lines of several threads stay whole. Nobody can be told if it fails.
  static_cast<void>(!::write(STDERR_FILENO, line.data(), line.size()));
}

}  // namespace gimbal
