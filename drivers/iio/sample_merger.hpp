#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "drivers/imu_source.hpp"

namespace gimbal {

/// When the sample was taken.
[[nodiscard]] SensorTime time_of(const ImuReading& reading);

/// Merges the samples of several devices in order of time. A device with nothing to offer is waited
/// for, but not longer than the patience: what it still delivers for the time that has gone out by
/// then is dropped and counted.
class SampleMerger {
 public:
  SampleMerger(std::size_t devices, SensorDuration patience);

  /// `device`: below the number of devices; each one's samples in order. `arrival`: host time.
  void push(std::size_t device, const ImuReading& reading, SensorTime arrival);

  /// The next sample, if it is known to be the next, or has waited long enough.
  [[nodiscard]] std::optional<ImuReading> pop(SensorTime now);

  /// Samples that came too late.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  struct Arrival {
    ImuReading reading;
    SensorTime time;
  };

  std::vector<std::deque<Arrival>> waiting_;
  SensorDuration patience_;
  std::optional<SensorTime> last_out_;
  std::uint64_t dropped_ = 0;
};

}  // namespace gimbal
