#pragma once

#include <cstdint>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// How a light that was to change at even steps did: the straight line through its changes' times.
class FlashTiming {
 public:
  /// `half`: from one change to the next, of a flash and its pause.
  explicit FlashTiming(SensorDuration half) : half_(half) {}

  /// `step`: which change it is, the first 0; some may be left out.
  void add(std::int64_t step, SensorTime time);

  /// Flashes a second as they came; as they were to come before there are two.
  [[nodiscard]] double hz() const;

  /// Standard deviation of the changes' times from the line.
  [[nodiscard]] double jitter_s() const;

 private:
  struct Line {
    double slope = 0;  ///< of lateness, s a step
    double residual_squares = 0;
  };
  [[nodiscard]] Line line() const;

  SensorDuration half_;
  SensorTime first_;
  double count_ = 0;
  // Means, and sums of products about them, of steps and lateness (Welford's recurrence).
  double mean_step_ = 0;
  double mean_late_s_ = 0;
  double steps_ = 0;
  double products_ = 0;
  double lates_ = 0;
};

}  // namespace gimbal
