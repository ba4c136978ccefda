#include "drivers/iio/gap_counter.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace gimbal {
namespace {

constexpr std::size_t kStepsToLearn = 8;
constexpr std::size_t kStepsHeld = 255;  // of which a burst is the smaller part
constexpr double kGapFrom = 1.75;      // in usual steps
constexpr double kCatchUpBelow = 0.5;  // in usual steps
constexpr std::size_t kStepsToSettle = 8;

}  // namespace

void GapCounter::take(SensorTime stamp) {
  if (last_) {
    const double step_s = to_seconds(stamp - *last_);
    if (const auto usual_s = usual_step_s()) settle(step_s / *usual_s);
    recent_steps_s_.push_back(step_s);
    if (recent_steps_s_.size() > kStepsHeld) recent_steps_s_.pop_front();
  }
  last_ = stamp;
}

std::optional<double> GapCounter::usual_step_s() const {
  if (recent_steps_s_.size() < kStepsToLearn) return std::nullopt;
  std::vector<double> steps(recent_steps_s_.begin(), recent_steps_s_.end());
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
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
