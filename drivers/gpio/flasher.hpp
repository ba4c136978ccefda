#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "drivers/gpio/flash_timing.hpp"
#include "drivers/gpio/gpio_lines.hpp"

namespace gimbal {

/// A light that flashes at a known frequency, half of the time on: in front of a rolling shutter it
/// draws bands whose height tells the readout time. On a thread of its own, from construction until
/// it goes, which leaves the light off.
class Flasher {
 public:
  /// How well the frequency was kept, so that who measures by it knows.
  struct Record {
    std::uint64_t flashes = 0;     ///< begun
    SensorDuration latest{};       ///< the most that a change came after its time
    std::uint64_t skipped = 0;     ///< changes that were more than half a flash late
    double hz = 0;                 ///< flashes a second as they came
    double jitter_s = 0;           ///< standard deviation of the changes' times from even ones
    std::optional<Error> failure;  ///< of the line; nothing flashes after it
  };

  /// bad_input unless 0 < hz <= kFastest_hz.
  [[nodiscard]] static Result<std::unique_ptr<Flasher>> start(std::unique_ptr<GpioOutput> light,
                                                              double hz);

  /// A sleeping thread of Linux without real time wakes within some 0.1 ms.
  static constexpr double kFastest_hz = 2000;

  Flasher(const Flasher&) = delete;
  Flasher& operator=(const Flasher&) = delete;
  ~Flasher();

  [[nodiscard]] Record record() const;

 private:
  Flasher(std::unique_ptr<GpioOutput> light, SensorDuration half);

  void run(const std::stop_token& stop);
  [[nodiscard]] bool change(std::int64_t step, SensorTime due);

  const std::unique_ptr<GpioOutput> light_;
  const SensorDuration half_;  ///< of a flash and its pause
  mutable std::mutex mutex_;
  Record record_;
  FlashTiming timing_;
  std::jthread thread_;
};

}  // namespace gimbal
