#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace gimbal {

struct LostAxesParameters {
  /// Below this a value that repeats is just coarse: no gyroscope has a smaller range.
  double smallest_limit_rad_s = 2;
  /// An axis that repeats its value for this long, while the others move, is stuck.
  double stuck_after_s = 0.5;
  double others_move_rad_s = 0.003;  ///< from one sample to the next, root mean square
};

/// Why an axis does not measure.
enum class AxisLoss : std::uint8_t { none, clipped, stuck };

/// Finds gyroscope axes that do not measure: at the end of their range, or stuck. A sensor's range
/// need not be known: a clipped axis repeats the largest value it has ever shown.
class LostAxes {
 public:
  explicit LostAxes(const LostAxesParameters& parameters = {}) : parameters_(parameters) {}

  /// Takes the next sample.
  std::array<AxisLoss, 3> update(const Eigen::Vector3d& gyro_rad_s, double interval_s);

 private:
  struct Axis {
    double largest_rad_s = 0;
    double value_rad_s = 0;
    double held_s = 0;
    double step_variance_rad2_s2 = 0;  ///< recent mean square of the change between samples
  };
  [[nodiscard]] AxisLoss loss_of(std::size_t axis) const;

  LostAxesParameters parameters_;
  std::array<Axis, 3> axes_;
};

}  // namespace gimbal
