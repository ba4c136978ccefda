#pragma once

#include <deque>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// Gives a sample the stamp of its data-ready edge: the one nearest to when the sample is reckoned
/// to have been taken, if it is within half a period. Edges that were lost leave the reckoned
/// instant.
class EdgeMatcher {
 public:
  /// In order of time.
  void take(SensorTime edge) { edges_.push_back(edge); }

  /// Samples in order.
  [[nodiscard]] SensorTime match(SensorTime reckoned, SensorDuration period) {
    while (!edges_.empty() && edges_.front() < reckoned - period / 2) edges_.pop_front();
    if (edges_.empty() || edges_.front() > reckoned + period / 2) return reckoned;
    const SensorTime edge = edges_.front();
    edges_.pop_front();
    return edge;
  }

  void clear() { edges_.clear(); }

 private:
  std::deque<SensorTime> edges_;
};

}  // namespace gimbal
