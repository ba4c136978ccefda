#include "daemon/repeated_lines.hpp"

#include <algorithm>
#include <utility>

namespace gimbal {

std::optional<RepeatedLines::Passed> RepeatedLines::pass(std::string_view line,
                                                         Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  const auto known = std::ranges::find_if(seen_, [&](const Seen& s) { return s.line == line; });
  if (known == seen_.end()) {
    seen_.push_front({std::string(line), now, 1, 0});
    if (seen_.size() > kRemembered) seen_.pop_back();
    return Passed{};
  }
  seen_.splice(seen_.begin(), seen_, known);
  Seen& seen = seen_.front();
  if (now - seen.first >= kWhile) {
    seen.first = now;
    seen.passed = 0;
  }
  if (seen.passed >= kAtOnce) {
    ++seen.held_back;
    return std::nullopt;
  }
  ++seen.passed;
  return Passed{std::exchange(seen.held_back, 0)};
}

}  // namespace gimbal
