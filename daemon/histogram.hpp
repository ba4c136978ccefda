#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// How many durations fell into each of some ranges. Any thread may add or read; nobody waits.
class Histogram {
 public:
  /// Upper ends, included; what is longer than the last counts beyond them.
  static constexpr std::array kBounds_s{0.001, 0.002, 0.005, 0.01, 0.02, 0.05,
                                        0.1,   0.2,   0.5,   1.0,  2.0};

  struct Counts {
    std::array<std::uint64_t, kBounds_s.size() + 1> in_range{};
    double sum_s = 0;
  };

  void add(SensorDuration duration) {
    const double seconds = to_seconds(duration);
    std::size_t range = 0;
    while (range < kBounds_s.size() && seconds > kBounds_s[range]) ++range;
    in_range_[range].fetch_add(1, std::memory_order_relaxed);
    sum_ns_.fetch_add(duration.count(), std::memory_order_relaxed);
  }

  [[nodiscard]] Counts counts() const {
    Counts counts;
    for (std::size_t i = 0; i < in_range_.size(); ++i) {
      counts.in_range[i] = in_range_[i].load(std::memory_order_relaxed);
    }
    counts.sum_s = to_seconds(SensorDuration(sum_ns_.load(std::memory_order_relaxed)));
    return counts;
  }

 private:
  std::array<std::atomic<std::uint64_t>, kBounds_s.size() + 1> in_range_{};
  std::atomic<std::int64_t> sum_ns_ = 0;
};

}  // namespace gimbal
