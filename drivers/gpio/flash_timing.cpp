#include "drivers/gpio/flash_timing.hpp"

#include <algorithm>
#include <cmath>

namespace gimbal {

void FlashTiming::add(std::int64_t step, SensorTime time) {
  if (count_ == 0) first_ = time - step * half_;
  const double late_s = to_seconds(time - first_ - step * half_);
  const double step_off = static_cast<double>(step) - mean_step_;
  const double late_off = late_s - mean_late_s_;
  ++count_;
  mean_step_ += step_off / count_;
  mean_late_s_ += late_off / count_;
  steps_ += step_off * (static_cast<double>(step) - mean_step_);
  products_ += step_off * (late_s - mean_late_s_);
  lates_ += late_off * (late_s - mean_late_s_);
}

FlashTiming::Line FlashTiming::line() const {
  if (steps_ == 0) return {};
  const double slope = products_ / steps_;
  return {slope, std::max(0.0, lates_ - slope * products_)};
}

double FlashTiming::hz() const {
  return 0.5 / (to_seconds(half_) + line().slope);
}

double FlashTiming::jitter_s() const {
  return count_ > 2 ? std::sqrt(line().residual_squares / (count_ - 2)) : 0;
}

}  // namespace gimbal
