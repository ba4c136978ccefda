#include "drivers/clock/kernel_clock.hpp"

#include <time.h>

#include <array>
#include <chrono>

namespace gimbal {
namespace {

/// Exposure, readout and a queue of pictures while the camera starts.
constexpr SensorDuration kOldest = std::chrono::seconds(1);
/// Some drivers stamp when the picture is planned to end, up to a frame ahead of its delivery: the
/// kernel's vivid does (vivid-kthread-cap.c, cap_frame_eof_offset).
constexpr SensorDuration kNewest = std::chrono::milliseconds(-50);

/// In the order of how likely they are.
constexpr std::array kClocks = {KernelClock::monotonic,     KernelClock::boottime,
                                KernelClock::monotonic_raw, KernelClock::realtime,
                                KernelClock::tai,           KernelClock::system_counter};

std::optional<clockid_t> clock_id(KernelClock clock) {
  switch (clock) {
    case KernelClock::monotonic:
      return CLOCK_MONOTONIC;
    case KernelClock::boottime:
      return CLOCK_BOOTTIME;
    case KernelClock::monotonic_raw:
      return CLOCK_MONOTONIC_RAW;
    case KernelClock::realtime:
      return CLOCK_REALTIME;
    case KernelClock::tai:
      return CLOCK_TAI;
    case KernelClock::system_counter:
      return std::nullopt;
  }
  return std::nullopt;
}

/// CNTVCT_EL0 and CNTFRQ_EL0 (Arm Architecture Reference Manual, D12): readable by programs on
/// Linux.
std::optional<SensorDuration> read_system_counter() {
#if defined(__aarch64__)
  std::uint64_t ticks = 0;
  std::uint64_t hertz = 0;
  asm volatile("isb; mrs %0, cntvct_el0" : "=r"(ticks));
  asm volatile("mrs %0, cntfrq_el0" : "=r"(hertz));
  if (hertz == 0) return std::nullopt;
  constexpr std::uint64_t kNanoseconds = 1'000'000'000;
  return SensorDuration(static_cast<std::int64_t>(ticks / hertz * kNanoseconds +
                                                  ticks % hertz * kNanoseconds / hertz));
#else
  return std::nullopt;
#endif
}

}  // namespace

std::string name_of(KernelClock clock) {
  switch (clock) {
    case KernelClock::monotonic:
      return "CLOCK_MONOTONIC";
    case KernelClock::boottime:
      return "CLOCK_BOOTTIME";
    case KernelClock::monotonic_raw:
      return "CLOCK_MONOTONIC_RAW";
    case KernelClock::realtime:
      return "CLOCK_REALTIME";
    case KernelClock::tai:
      return "CLOCK_TAI";
    case KernelClock::system_counter:
      return "the processor's system counter";
  }
  return {};
}

std::optional<KernelClock> find_clock(SensorDuration stamp, const ReadClock& now) {
  for (const KernelClock clock : kClocks) {
    const auto time = now(clock);
    if (!time) continue;
    const SensorDuration age = *time - stamp;
    if (age >= kNewest && age <= kOldest) return clock;
  }
  return std::nullopt;
}

std::optional<SensorDuration> read_kernel_clock(KernelClock clock) {
  const auto id = clock_id(clock);
  if (!id) return read_system_counter();
  timespec now{};
  if (::clock_gettime(*id, &now) != 0) return std::nullopt;
  return std::chrono::seconds(now.tv_sec) + SensorDuration(now.tv_nsec);
}

SensorTime to_monotonic(SensorDuration stamp, KernelClock clock, const ReadClock& now) {
  if (clock == KernelClock::monotonic) return SensorTime(stamp);
  const auto before = now(KernelClock::monotonic);
  const auto other = now(clock);
  const auto after = now(KernelClock::monotonic);
  if (!before || !other || !after) return SensorTime(stamp);
  return SensorTime(stamp - *other + *before + (*after - *before) / 2);
}

}  // namespace gimbal
