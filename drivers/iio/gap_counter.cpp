#include "drivers/iio/gap_counter.hpp"

#include <algorithm>
#include <cmath>

namespace gimbal {
namespace {

constexpr std::size_t kStepsToLearn = 8;
constexpr double kGapFrom = 1.75;      // in usual steps
constexpr double kCatchUpBelow = 0.5;  // in usual steps
constexpr std::size_t kStepsToSettle = 8;

}  // namespace

void GapCounter::take(SensorTime stamp) {
  if (last_) {
    const double step_s = to_seconds(stamp - *last_);
    if (const auto usual_s = usual_step_s()) settle(step_s / *usual_s);
    steps_s_[steps_seen_++ % kStepsHeld] = step_s;
  }
  last_ = stamp;
}

std::optional<double> GapCounter::usual_step_s() const {
  const std::size_t held = std::min(steps_seen_, kStepsHeld);
  if (held < kStepsToLearn) return std::nullopt;
  std::array<double, kStepsHeld> steps = steps_s_;
  auto* const middle = steps.data() + held / 2;
  std::nth_element(steps.data(), middle, steps.data() + held);
  return *middle;
}

void GapCounter::settle(double steps) {
  if (steps >= kGapFrom) {
    suspected_ += static_cast<std::uint64_t>(std::lround(steps)) - 1;
    steps_since_gap_ = 0;
    return;
  }
  if (steps < kCatchUpBelow && suspected_ > 0) {
    --suspected_;
    return;
  }
  if (++steps_since_gap_ < kStepsToSettle) return;
  missing_ += suspected_;
  suspected_ = 0;
}

}  // namespace gimbal
