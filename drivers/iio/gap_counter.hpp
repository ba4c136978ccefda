#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// Counts the samples that are missing in a stream of even rate, which is all that shows when the
/// kernel's buffer ran over. The rate is learnt from the stamps. A sample that was only late is
/// made up for by the short steps after it, and not counted.
class GapCounter {
 public:
  void take(SensorTime stamp);

  [[nodiscard]] std::uint64_t missing() const { return missing_; }

 private:
  static constexpr std::size_t kStepsHeld = 255;  ///< of which a burst is the smaller part

  [[nodiscard]] std::optional<double> usual_step_s() const;
  void settle(double steps);

  std::optional<SensorTime> last_;
  std::array<double, kStepsHeld> steps_s_{};  ///< a ring of the latest
  std::size_t steps_seen_ = 0;
  std::uint64_t missing_ = 0;
  std::uint64_t suspected_ = 0;      ///< missing, unless they come at once
  std::size_t steps_since_gap_ = 0;  ///< since the last that was suspected
};

}  // namespace gimbal
