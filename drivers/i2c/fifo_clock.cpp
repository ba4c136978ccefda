#include "drivers/i2c/fifo_clock.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gimbal {
namespace {

/// Data sheets promise an oscillator within 1 to 3 %.
constexpr double kNominalSpread = 0.04;
/// By how much the period may change over a restart, with temperature.
constexpr double kLeastSpread = 1e-3;
constexpr double kWindow_s = 5;
constexpr double kBucket_s = 0.1;
constexpr int kSearchSteps = 50;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

FifoClock::FifoClock(SensorDuration nominal_period)
    : prior_period_s_(to_seconds(nominal_period)),
      prior_spread_(kNominalSpread),
      period_s_(prior_period_s_),
      half_width_s_(prior_spread_ * prior_period_s_) {}

void FifoClock::observe(SensorTime asked, SensorTime answered, std::uint64_t waiting) {
  if (buckets_.empty()) origin_ = asked;
  const auto produced = static_cast<double>(taken_ + waiting);
  Bucket& bucket = bucket_at(seconds_of(answered));
  const auto offset = [this](const Bound& bound) { return bound.time_s - period_s_ * bound.index; };
  const Bound upper{produced - 1, seconds_of(answered)};
  const Bound lower{produced, seconds_of(asked)};
  if (produced > 0 && (!bucket.upper || offset(upper) < offset(*bucket.upper))) {
    bucket.upper = upper;
  }
  if (!bucket.lower || offset(lower) > offset(*bucket.lower)) bucket.lower = lower;
  fit();
}

FifoClock::Bucket& FifoClock::bucket_at(double time_s) {
  if (buckets_.empty() || time_s - buckets_.back().begin_s >= kBucket_s) {
    buckets_.push_back({time_s, {}, {}});
  }
  while (time_s - buckets_.front().begin_s > kWindow_s) buckets_.pop_front();
  return buckets_.back();
}

/// The middle of the periods that are possible, and with it the middle of the phases.
void FifoClock::fit() {
  const double least_s = prior_period_s_ * (1 - prior_spread_);
  const double most_s = prior_period_s_ * (1 + prior_spread_);
  period_s_ = roomiest_period();
  half_width_s_ = 0;
  if (room(period_s_) > 0) {
    const double shortest_s = edge_of_room(period_s_, least_s);
    const double longest_s = edge_of_room(period_s_, most_s);
    period_s_ = (shortest_s + longest_s) / 2;
    half_width_s_ = (longest_s - shortest_s) / 2;
  }
  const double above_s = lowest_upper(period_s_);
  const double below_s = highest_lower(period_s_);
  phase_s_ = std::isfinite(above_s) ? (above_s + below_s) / 2 : below_s + period_s_ / 2;
}

double FifoClock::lowest_upper(double period_s) const {
  double lowest = kInfinity;
  for (const Bucket& bucket : buckets_) {
    if (bucket.upper)
      lowest = std::min(lowest, bucket.upper->time_s - period_s * bucket.upper->index);
  }
  return lowest;
}

double FifoClock::highest_lower(double period_s) const {
  double highest = -kInfinity;
  for (const Bucket& bucket : buckets_) {
    if (bucket.lower) {
      highest = std::max(highest, bucket.lower->time_s - period_s * bucket.lower->index);
    }
  }
  return highest;
}

/// How far the bounds let the line be moved, negative if they forbid it; concave in the period.
double FifoClock::room(double period_s) const {
  return lowest_upper(period_s) - highest_lower(period_s);
}

double FifoClock::roomiest_period() const {
  double least_s = prior_period_s_ * (1 - prior_spread_);
  double most_s = prior_period_s_ * (1 + prior_spread_);
  if (!std::isfinite(room(prior_period_s_))) return prior_period_s_;
  for (int i = 0; i < kSearchSteps; ++i) {
    const double third_s = (most_s - least_s) / 3;
    if (room(least_s + third_s) < room(most_s - third_s)) {
      least_s += third_s;
    } else {
      most_s -= third_s;
    }
  }
  return (least_s + most_s) / 2;
}

/// The period between one with room and one perhaps without, up to which there is room.
double FifoClock::edge_of_room(double inside_s, double outside_s) const {
  if (room(outside_s) > 0) return outside_s;
  for (int i = 0; i < kSearchSteps; ++i) {
    const double middle_s = (inside_s + outside_s) / 2;
    (room(middle_s) > 0 ? inside_s : outside_s) = middle_s;
  }
  return inside_s;
}

SensorTime FifoClock::take() {
  const double time_s = phase_s_ + period_s_ * static_cast<double>(taken_);
  ++taken_;
  SensorTime time = origin_ + duration_from_seconds(time_s);
  if (last_) time = std::max(time, *last_ + SensorDuration(1));
  last_ = time;
  return time;
}

std::uint64_t FifoClock::waiting_at(SensorTime time) const {
  if (buckets_.empty()) return 0;
  const double produced = std::floor((seconds_of(time) - phase_s_) / period_s_) + 1;
  return static_cast<std::uint64_t>(std::max(0.0, produced - static_cast<double>(taken_)));
}

void FifoClock::restart() {
  if (!buckets_.empty()) {
    prior_period_s_ = period_s_;
    prior_spread_ = std::clamp(half_width_s_ / period_s_, kLeastSpread, kNominalSpread);
  }
  buckets_.clear();
  taken_ = 0;
}

}  // namespace gimbal
