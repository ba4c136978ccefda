#include "daemon/journal.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "daemon/repeated_lines.hpp"

namespace gimbal {
namespace {

void write_line(LogLevel level, const std::string& text) {
  static const bool is_journal = std::getenv("JOURNAL_STREAM") != nullptr;
  const std::string line = is_journal ? fmt::format("<{}>{}\n", static_cast<int>(level), text)
                                      : fmt::format("gimbald: {}\n", text);
  // One write, so that the lines of several threads stay whole. Nobody can be told if it fails.
  static_cast<void>(!::write(STDERR_FILENO, line.data(), line.size()));
}

}  // namespace

void log_line(LogLevel level, std::string_view text) {
  static RepeatedLines repeated;
  const auto passed = repeated.pass(text, std::chrono::steady_clock::now());
  if (!passed) return;
  write_line(level, passed->held_back == 0
                        ? std::string(text)
                        : fmt::format("{} ({} more such lines before)", text, passed->held_back));
}

}  // namespace gimbal
