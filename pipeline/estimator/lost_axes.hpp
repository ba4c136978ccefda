#pragma once

#include <Eigen/Core>
#include <array>

namespace gimbal {

struct LostAxesParameters {
  /// Below this a value that repeats is just coarse: sensors clip far above it.
  double smallest_limit_rad_s = 1;
  /// An axis that repeats its value for this long, while the others move, is stuck.
  double stuck_after_s = 0.5;
  double others_move_rad_s = 0.003;  ///< from one sample to the next, root mean square
};

/// Finds gyroscope axes that do not measure: at the end of their range, or stuck. A sensor's range
/// need not be known: a clipped axis repeats the largest value it has ever shown.
class LostAxes {
 public:
  explicit LostAxes(const LostAxesParameters& parameters = {}) : parameters_(parameters) {}

  /// Takes the next sample; true for the axes that are lost.
  std::array<bool, 3> update(const Eigen::Vector3d& gyro_rad_s, double interval_s);

 private:
  struct Axis {
    double largest_rad_s = 0;
    double value_rad_s = 0;
    double held_s = 0;
    double step_variance_rad2_s2 = 0;  ///< recent mean square of the change between samples
  };
  [[nodiscard]] bool is_lost(std::size_t axis) const;

  LostAxesParameters parameters_;
  std::array<Axis, 3> axes_;
};

}  // namespace gimbal
