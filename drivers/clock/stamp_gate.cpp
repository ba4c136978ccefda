#include "drivers/clock/stamp_gate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace gimbal {
namespace {

using std::chrono::seconds;

/// Stamps of another clock are off by a device's uptime or by an epoch; stamps of the right one by
/// no more than a reader lags behind.
constexpr SensorDuration kClockTolerance = seconds(1);

/// So many stamps after a jump must go on from each other before they are believed.
constexpr int kSteadyStamps = 3;

/// Within one window crystals part by less than the arrivals' own noise.
constexpr SensorDuration kWindow = seconds(5);

/// How fast a mapping follows: 1 ms a second, faster than any crystal drifts, and too slow to
/// matter to an integrated rate.
constexpr std::int64_t kSlewDivisor = 1000;

SensorDuration magnitude(SensorDuration duration) {
  return duration < SensorDuration::zero() ? -duration : duration;
}

bool is_small_step(SensorDuration step) {
  return step > SensorDuration::zero() && step < kClockTolerance;
}

}  // namespace

StampGate::StampGate(std::string device, ForeignClock foreign_clock)
    : device_(std::move(device)), foreign_clock_(foreign_clock) {}

Result<std::optional<SensorTime>> StampGate::pass(SensorTime stamp, SensorTime arrival) {
  const std::optional<SensorTime> refused;
  if (!last_stamp_) {
    if (auto anchored = anchor(stamp, arrival); !anchored) return tl::unexpected(anchored.error());
  } else if (!goes_on(stamp, arrival)) {
    const auto survived = survives_jump(stamp, arrival);
    if (!survived) return tl::unexpected(survived.error());
    if (!*survived) {
      ++refused_;
      return refused;
    }
  }
  if (is_foreign_) follow_clock(stamp, arrival);
  jumped_to_.reset();
  last_stamp_ = stamp;
  const SensorTime out = stamp + offset_;
  if (last_out_ && out <= *last_out_) {
    ++refused_;
    return refused;
  }
  last_out_ = out;
  return out;
}

Result<void> StampGate::anchor(SensorTime stamp, SensorTime arrival) {
  const SensorDuration delay = arrival - stamp;
  is_foreign_ = magnitude(delay) >= kClockTolerance;
  if (is_foreign_ && foreign_clock_ == ForeignClock::refuse) {
    return failed(
        fmt::format("{}: its stamps are {:.3f} s off CLOCK_MONOTONIC, from a clock of its own; let "
                    "them be mapped, or use another device",
                    device_, to_seconds(delay)));
  }
  offset_ = is_foreign_ ? delay : SensorDuration::zero();
  window_begin_ = stamp;
  least_delay_ = least_delay_before_ = delay;
  return {};
}

/// Small steps are a steady clock's; a long one is a pause if the host's clock has made it too.
bool StampGate::goes_on(SensorTime stamp, SensorTime arrival) const {
  const SensorDuration step = stamp - *last_stamp_;
  if (is_small_step(step)) return true;
  const SensorDuration age = arrival - (stamp + offset_);
  return step > SensorDuration::zero() && magnitude(age) < kClockTolerance;
}

/// A stamp that is late by less than a jump is only refused.
Result<bool> StampGate::survives_jump(SensorTime stamp, SensorTime arrival) {
  const SensorDuration step = stamp - *last_stamp_;
  if (magnitude(step) < kClockTolerance) return false;
  const bool is_steady = jumped_to_ && is_small_step(stamp - *jumped_to_);
  steady_since_jump_ = is_steady ? steady_since_jump_ + 1 : 1;
  jumped_to_ = stamp;
  if (steady_since_jump_ < kSteadyStamps) return false;
  ++jumps_;
  last_jump_ = step;
  if (auto anchored = anchor(stamp, arrival); !anchored) return tl::unexpected(anchored.error());
  return true;
}

/// Arrivals are late by what the reader's thread waited; the least late ones are not. A least delay
/// of two windows forgets, so that it follows a drift upwards, too.
void StampGate::follow_clock(SensorTime stamp, SensorTime arrival) {
  const SensorDuration delay = arrival - stamp;
  least_delay_ = std::min(least_delay_, delay);
  if (stamp - window_begin_ >= kWindow) {
    least_delay_before_ = std::exchange(least_delay_, delay);
    window_begin_ = stamp;
  }
  const SensorDuration ahead = std::min(least_delay_, least_delay_before_) - offset_;
  const SensorDuration step =
      last_stamp_ ? magnitude(stamp - *last_stamp_) : SensorDuration::zero();
  const SensorDuration most = std::min(step, kClockTolerance) / kSlewDivisor;
  offset_ += std::clamp(ahead, -most, most);
}

std::vector<std::string> StampGate::remarks() const {
  std::vector<std::string> lines;
  if (jumps_ > 0) {
    lines.push_back(fmt::format("{}: its clock jumped {} time(s), last by {:+.3f} s", device_,
                                jumps_, to_seconds(last_jump_)));
  }
  if (is_foreign_) {
    lines.push_back(
        fmt::format("{}: stamps by a clock of its own, {:.3f} s off CLOCK_MONOTONIC; mapped by "
                    "arrival, so measure the camera's time offset with this device",
                    device_, to_seconds(offset_)));
  }
  if (refused_ > 0) {
    lines.push_back(
        fmt::format("{}: {} sample(s) left out because of their stamps", device_, refused_));
  }
  return lines;
}

}  // namespace gimbal
