#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "pipeline/sample/attitude.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// Orientations for pictures that cannot wait. What a filter says at each sample jumps where it
/// corrects itself, most of all while it still finds out which way is up; inside of a frame, rows
/// apart, that is seen as wobble. Here each answer is where the gyroscope leads from the one
/// before, drawn to the filter's with a time constant: what is right comes late, the turn from row
/// to row is the gyroscope's. A filter that began lately knows little, and is followed faster, but
/// never by more than four degrees a second.
class GradualCorrection {
 public:
  explicit GradualCorrection(SensorDuration memory) : memory_s_(to_seconds(memory)) {}

  /// The filter's next answer, and the rate (rad/s, IMU axes, its bias taken off) at its instant.
  [[nodiscard]] Eigen::Quaterniond follow(const Attitude& estimate,
                                          const Eigen::Vector3d& rate_rad_s);

 private:
  struct Shown {
    Attitude attitude;
    Eigen::Vector3d rate_rad_s;
  };

  double memory_s_;
  std::optional<Shown> last_;
  double age_s_ = 0;
};

}  // namespace gimbal
