#pragma once

#include <algorithm>
#include <atomic>
#include <optional>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// How many samples come a second, by their stamps: the mean over the last some hundred. One thread
/// adds, any may ask.
class SampleRate {
 public:
  void add(SensorTime time) {
    if (last_ && time > *last_) {
      const double interval_s = to_seconds(time - *last_);
      ++count_;
      const double share = 1.0 / std::min(count_, kMemory);
      mean_interval_s_ += share * (interval_s - mean_interval_s_);
      if (count_ >= kMemory) rate_hz_ = 1 / mean_interval_s_;
    }
    last_ = time;
  }

  /// 0 until enough have come.
  [[nodiscard]] double rate_hz() const { return rate_hz_; }

 private:
  static constexpr double kMemory = 200;

  std::optional<SensorTime> last_;
  double count_ = 0;
  double mean_interval_s_ = 0;
  std::atomic<double> rate_hz_ = 0;
};

}  // namespace gimbal
