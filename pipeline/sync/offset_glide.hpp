#pragma once

#include <optional>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// Lets the offset that frames are drawn with come to the one that is wanted so slowly that the
/// picture does not jump: at a millisecond a second, or, if it is far off, by as much as closes the
/// gap by 1/e in half a second. Never so fast that rows of a later frame come before an earlier
/// one's.
class OffsetGlide {
 public:
  /// For the frame with this stamp; they rise.
  SensorDuration towards(SensorDuration wanted, SensorTime frame);

 private:
  SensorDuration offset_{};
  std::optional<SensorTime> last_;
};

}  // namespace gimbal
