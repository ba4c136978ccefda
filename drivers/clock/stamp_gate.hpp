#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// What is done with stamps that a device takes from a clock of its own, as sensor hubs do.
enum class ForeignClock : std::uint8_t {
  map,     ///< put onto CLOCK_MONOTONIC by their earliest arrivals; a constant delay remains
  refuse,  ///< an error
};

/// Lets a device's stamps through as instants of CLOCK_MONOTONIC that strictly rise. Each stamp is
/// held against the host's time at its arrival: at the start, to learn whether its clock is
/// CLOCK_MONOTONIC at all, and wherever it steps, to tell a pause of the device from a jump of its
/// clock. After a jump nothing comes out until the new stamps have proved to go on steadily.
class StampGate {
 public:
  /// `device`: what errors and remarks call it.
  StampGate(std::string device, ForeignClock foreign_clock);

  /// `arrival`: when the sample was read. Nothing for a stamp that is refused: not later than the
  /// one before, or part of a jump.
  [[nodiscard]] Result<std::optional<SensorTime>> pass(SensorTime stamp, SensorTime arrival);

  /// Samples whose stamp was refused.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

  /// Times that the clock jumped.
  [[nodiscard]] std::uint64_t jumps() const { return jumps_; }

  [[nodiscard]] std::vector<std::string> remarks() const;

 private:
  [[nodiscard]] Result<void> anchor(SensorTime stamp, SensorTime arrival);
  [[nodiscard]] bool goes_on(SensorTime stamp, SensorTime arrival) const;
  [[nodiscard]] Result<bool> survives_jump(SensorTime stamp, SensorTime arrival);
  void follow_clock(SensorTime stamp, SensorTime arrival);

  std::string device_;
  ForeignClock foreign_clock_;

  std::optional<SensorTime> last_stamp_;  ///< that was let through
  std::optional<SensorTime> last_out_;
  SensorDuration offset_{};  ///< from the stamps to CLOCK_MONOTONIC
  bool is_foreign_ = false;

  // The shortest way from stamp to arrival, in this window and in the one before.
  SensorTime window_begin_;
  SensorDuration least_delay_{};
  SensorDuration least_delay_before_{};

  std::optional<SensorTime> jumped_to_;  ///< the last stamp after a jump
  int steady_since_jump_ = 0;

  std::uint64_t refused_ = 0;
  std::uint64_t jumps_ = 0;
  SensorDuration last_jump_{};
};

}  // namespace gimbal
