#include "daemon/journal.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "daemon/repeated_lines.hpp"

#ifdef GIMBALD_HAS_SYSTEMD
#include <sys/stat.h>
#include <sys/uio.h>
#define SD_JOURNAL_SUPPRESS_LOCATION  // one function logs for all
#include <systemd/sd-journal.h>

#include <cstdlib>
#endif

namespace gimbal {
namespace {

void write_line(const std::string& text) {
  const std::string line = fmt::format("gimbald: {}\n", text);
  // One write, so that the lines of several threads stay whole. Nobody can be told if it fails.
  static_cast<void>(!::write(STDERR_FILENO, line.data(), line.size()));
}

#ifdef GIMBALD_HAS_SYSTEMD
/// Whether standard error is what systemd made it: a program that began in a service may have been
/// given another (systemd.exec(5), JOURNAL_STREAM).
bool writes_to_journal() {
  const char* const stream = std::getenv("JOURNAL_STREAM");
  struct stat status {};
  return stream != nullptr && ::fstat(STDERR_FILENO, &status) == 0 &&
         fmt::format("{}:{}", status.st_dev, status.st_ino) == stream;
}

bool send_to_journal(const std::vector<std::string>& fields) {
  static const bool is_journal = writes_to_journal();
  if (!is_journal) return false;
  std::vector<iovec> parts;
  for (const std::string& field : fields) {
    parts.push_back({const_cast<char*>(field.data()), field.size()});  // which is only read
  }
  return ::sd_journal_sendv(parts.data(), static_cast<int>(parts.size())) == 0;
}
#else
bool send_to_journal(const std::vector<std::string>& /*fields*/) {
  return false;
}
#endif

}  // namespace

std::vector<std::string> journal_fields(LogLevel level, std::string_view text, LogSubject subject,
                                        std::uint64_t held_back) {
  std::vector<std::string> fields{fmt::format("MESSAGE={}", text),
                                  fmt::format("PRIORITY={}", static_cast<int>(level)),
                                  "SYSLOG_IDENTIFIER=gimbald"};
  if (!subject.part.empty()) fields.push_back(fmt::format("GIMBALD_PART={}", subject.part));
  if (!subject.name.empty()) fields.push_back(fmt::format("GIMBALD_NAME={}", subject.name));
  if (held_back > 0) fields.push_back(fmt::format("GIMBALD_HELD_BACK={}", held_back));
  return fields;
}

void log_line(LogLevel level, std::string_view text, LogSubject subject) {
  // Never destroyed: an output that was left behind may have something to say to the last.
  static RepeatedLines& repeated = *new RepeatedLines;
  const auto passed = repeated.pass(text, std::chrono::steady_clock::now());
  if (!passed) return;
  const std::string line = passed->held_back == 0 ? std::string(text)
                                                  : fmt::format("{} ({} more such lines before)",
                                                                text, passed->held_back);
  if (send_to_journal(journal_fields(level, line, subject, passed->held_back))) return;
  write_line(line);
}

}  // namespace gimbal
