#include "drivers/v4l2/stamp_clock.hpp"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <array>
#include <chrono>
#include <limits>

namespace gimbal {
namespace {

/// Exposure, readout and a queue of pictures while the camera starts.
constexpr SensorDuration kOldest = std::chrono::seconds(1);
/// Stamps have a grain of a microsecond; clocks are read one after the other.
constexpr SensorDuration kNewest = std::chrono::milliseconds(-1);

/// In the order of how likely they are.
constexpr std::array kClocks = {StampClock::monotonic,     StampClock::boottime,
                                StampClock::monotonic_raw, StampClock::realtime,
                                StampClock::tai,           StampClock::system_counter};

}  // namespace

std::string name_of(StampClock clock) {
  switch (clock) {
    case StampClock::monotonic:
      return "CLOCK_MONOTONIC";
    case StampClock::boottime:
      return "CLOCK_BOOTTIME";
    case StampClock::monotonic_raw:
      return "CLOCK_MONOTONIC_RAW";
    case StampClock::realtime:
      return "CLOCK_REALTIME";
    case StampClock::tai:
      return "CLOCK_TAI";
    case StampClock::system_counter:
      return "the processor's system counter";
  }
  return {};
}

std::optional<StampClock> find_clock(SensorDuration stamp, const ReadClock& now) {
  for (const StampClock clock : kClocks) {
    const auto time = now(clock);
    if (!time) continue;
    const SensorDuration age = *time - stamp;
    if (age >= kNewest && age <= kOldest) return clock;
  }
  return std::nullopt;
}

std::string oddity_of(StampClock clock, std::uint32_t buffer_flags) {
  if (clock != StampClock::monotonic) {
    return fmt::format("its stamps are by {}; they are converted to CLOCK_MONOTONIC",
                       name_of(clock));
  }
  if ((buffer_flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) {
    return "its driver does not say by which clock it stamps; CLOCK_MONOTONIC fits";
  }
  return {};
}

SensorTime to_monotonic(SensorDuration stamp, StampClock clock, const ReadClock& now) {
  if (clock == StampClock::monotonic) return SensorTime(stamp);
  const auto before = now(StampClock::monotonic);
  const auto other = now(clock);
  const auto after = now(StampClock::monotonic);
  if (!before || !other || !after) return SensorTime(stamp);
  return SensorTime(stamp - *other + *before + (*after - *before) / 2);
}

TimestampReference claimed_reference(std::uint32_t buffer_flags) {
  const bool is_start =
      (buffer_flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  return is_start ? TimestampReference::exposure_start : TimestampReference::readout_end;
}

std::string describe_stamps(std::uint32_t buffer_flags) {
  const std::uint32_t clock = buffer_flags & V4L2_BUF_FLAG_TIMESTAMP_MASK;
  const char* by = clock == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC ? "CLOCK_MONOTONIC"
                   : clock == V4L2_BUF_FLAG_TIMESTAMP_COPY    ? "whoever writes into it"
                                                              : "an unknown clock";
  const char* instant = claimed_reference(buffer_flags) == TimestampReference::exposure_start
                            ? "the start of exposure"
                            : "the end of the frame";
  return fmt::format("stamps: by {}, at {} (as the driver says)", by, instant);
}

SequenceCounter::Step SequenceCounter::next(std::uint32_t sequence) {
  const bool is_first = !last_.has_value();
  const std::uint32_t step = is_first ? 0 : sequence - *last_;
  last_ = sequence;
  if (is_first) return {index_, 0};
  const bool has_risen = step != 0 && step <= std::numeric_limits<std::uint32_t>::max() / 2;
  index_ += has_risen ? step : 1;
  return {index_, has_risen ? step - 1 : 0};
}

}  // namespace gimbal
