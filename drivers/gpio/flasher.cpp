#include "drivers/gpio/flasher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <utility>

#include "drivers/clock/monotonic_now.hpp"

namespace gimbal {
namespace {

/// Sleeps until a time comes, or a stop.
class Sleeper {
 public:
  explicit Sleeper(const std::stop_token& stop) : stop_(stop) {}

  /// Whether the time came before the stop.
  [[nodiscard]] bool sleep_until(SensorTime time) {
    std::unique_lock lock(mutex_);
    const std::chrono::steady_clock::time_point when(time.time_since_epoch());
    woken_.wait_until(lock, stop_, when, [] { return false; });
    return !stop_.stop_requested();
  }

 private:
  std::stop_token stop_;
  std::mutex mutex_;
  std::condition_variable_any woken_;
};

}  // namespace

Result<std::unique_ptr<Flasher>> Flasher::start(std::unique_ptr<GpioOutput> light, double hz) {
  if (!(hz > 0 && hz <= kFastest_hz)) {
    return bad_input(
        fmt::format("a light cannot flash at {} Hz: above 0 and at most {}", hz, kFastest_hz));
  }
  return std::unique_ptr<Flasher>(new Flasher(std::move(light), duration_from_seconds(0.5 / hz)));
}

Flasher::Flasher(std::unique_ptr<GpioOutput> light, SensorDuration half)
    : light_(std::move(light)),
      half_(half),
      timing_(half),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Flasher::~Flasher() {
  thread_.request_stop();
  thread_.join();
  static_cast<void>(light_->set(GpioLevel::inactive));  // nobody can be told if it fails
}

Flasher::Record Flasher::record() const {
  const std::lock_guard lock(mutex_);
  Record record = record_;
  record.hz = timing_.hz();
  record.jitter_s = timing_.jitter_s();
  return record;
}

/// Every change is due at a multiple of half a flash from the start, so that lateness of one is not
/// handed on.
void Flasher::run(const std::stop_token& stop) {
  Sleeper sleeper(stop);
  const SensorTime begin = monotonic_now();
  for (std::int64_t step = 0; sleeper.sleep_until(begin + step * half_); ++step) {
    if (!change(step, begin + step * half_)) return;
  }
}

/// False when the line has failed. A change that would come after the next is due is left out: the
/// light then stays as it is, in step with those to come.
bool Flasher::change(std::int64_t step, SensorTime due) {
  const GpioLevel level = step % 2 == 0 ? GpioLevel::active : GpioLevel::inactive;
  const SensorDuration late = monotonic_now() - due;
  const bool is_skipped = late > half_;
  const auto set = is_skipped ? Result<void>() : light_->set(level);
  const SensorTime changed = monotonic_now();
  const std::lock_guard lock(mutex_);
  record_.latest = std::max(record_.latest, late);
  if (is_skipped) {
    ++record_.skipped;
    return true;
  }
  if (!set) {
    record_.failure = set.error();
    return false;
  }
  timing_.add(step, changed);
  if (level == GpioLevel::active) ++record_.flashes;
  return true;
}

}  // namespace gimbal
