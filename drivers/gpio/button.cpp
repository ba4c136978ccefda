#include "drivers/gpio/button.hpp"

#include <algorithm>

#include "drivers/clock/monotonic_now.hpp"

namespace gimbal {

void Debouncer::take(const Edge& edge) {
  latest_ = edge.direction;
  changed_ = edge.time;
}

std::optional<SensorTime> Debouncer::press(SensorTime now) {
  if (latest_ == steady_ || now - changed_ < period_) return std::nullopt;
  steady_ = latest_;
  return steady_ == EdgeDirection::rising ? std::optional(changed_) : std::nullopt;
}

std::optional<SensorTime> Debouncer::settles_at() const {
  return latest_ != steady_ ? std::optional(changed_ + period_) : std::nullopt;
}

Result<std::optional<SensorTime>> Button::wait_for_press(SensorTime deadline) {
  while (true) {
    // Edges that wait come first: they may tell that what looks steady was not.
    auto edge = edges_->read_until(monotonic_now());
    if (edge && !*edge) {
      if (const auto press = debouncer_.press(monotonic_now())) return press;
      const SensorTime until = std::min(deadline, debouncer_.settles_at().value_or(deadline));
      edge = edges_->read_until(until);
      const bool is_stopped = edge && !*edge && monotonic_now() < until;
      if (is_stopped || (edge && !*edge && until == deadline)) return std::optional<SensorTime>();
    }
    if (!edge) return tl::unexpected(edge.error());
    if (!*edge) continue;
    const auto press = debouncer_.press((*edge)->time);
    debouncer_.take(**edge);
    if (press) return press;
  }
}

}  // namespace gimbal
