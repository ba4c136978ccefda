#pragma once

#include <chrono>
#include <cstdint>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace gimbal {

/// Keeps a fault that comes again and again from filling the log: the same line passes a few times
/// and then once in a while, with how many were held back. Any thread may ask.
class RepeatedLines {
 public:
  using Clock = std::chrono::steady_clock;

  struct Passed {
    std::uint64_t held_back = 0;  ///< of the same line since it passed last
  };

  /// Nothing if the line is to be held back.
  [[nodiscard]] std::optional<Passed> pass(std::string_view line, Clock::time_point now);

 private:
  struct Seen {
    std::string line;
    Clock::time_point first;  ///< of those that pass one after another
    int passed = 0;
    std::uint64_t held_back = 0;
  };

  static constexpr int kAtOnce = 3;
  static constexpr std::chrono::seconds kWhile{30};
  static constexpr std::size_t kRemembered = 32;

  std::mutex mutex_;
  std::list<Seen> seen_;  ///< the latest first
};

}  // namespace gimbal
