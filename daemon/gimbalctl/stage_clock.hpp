#pragma once

#include <chrono>
#include <utility>

namespace gimbal {

/// Adds up the wall time that one stage takes on the calling thread.
class StageClock {
 public:
  /// Runs `work`, measured, and returns what it returns.
  template <typename Work>
  auto measure(Work&& work) {
    const Lap lap(total_);
    return std::forward<Work>(work)();
  }

  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(total_).count(); }

 private:
  using Clock = std::chrono::steady_clock;

  class Lap {
   public:
    explicit Lap(Clock::duration& total) : total_(total), begin_(Clock::now()) {}
    Lap(const Lap&) = delete;
    Lap& operator=(const Lap&) = delete;
    ~Lap() { total_ += Clock::now() - begin_; }

   private:
    Clock::duration& total_;
    Clock::time_point begin_;
  };

  Clock::duration total_{};
};

}  // namespace gimbal
