#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace gimbal {

/// In the sensor's unit: rad/s or m/s².
struct LostAxesParameters {
  /// Below this a value that repeats is just coarse: no sensor has a smaller range.
  double smallest_limit = 0;
  /// A largest value that lasts this long is a limit: single repeats come by chance.
  double clipped_after_s = 0.008;
  /// An axis that repeats its value for this long, while the others move, is stuck.
  double stuck_after_s = 0.5;
  double others_move = 0;  ///< from one sample to the next, root mean square
};

inline constexpr LostAxesParameters kLostGyroAxes{2, 0.008, 0.5, 0.003};
/// Accelerometers are coarser, so that at rest an axis may well repeat itself: no harm is done
/// then.
inline constexpr LostAxesParameters kLostAccelAxes{15, 0.008, 1, 0.03};

/// Why an axis does not measure.
enum class AxisLoss : std::uint8_t { none, clipped, stuck };
using AxisLosses = std::array<AxisLoss, 3>;

/// Finds axes of a gyroscope or an accelerometer that do not measure: at the end of their range, or
/// stuck. A sensor's range need not be known: a clipped axis repeats the largest value it has ever
/// shown.
class LostAxes {
 public:
  explicit LostAxes(const LostAxesParameters& parameters) : parameters_(parameters) {}

  /// Takes the next sample.
  const AxisLosses& update(const Eigen::Vector3d& values, double interval_s);

  /// At the last sample.
  [[nodiscard]] const AxisLosses& losses() const { return losses_; }

 private:
  struct Axis {
    double largest = 0;
    double value = 0;
    double held_s = 0;
    double step_variance = 0;  ///< recent mean square of the change between samples
  };
  [[nodiscard]] AxisLoss loss_of(std::size_t axis) const;

  LostAxesParameters parameters_;
  std::array<Axis, 3> axes_;
  AxisLosses losses_{};
};

}  // namespace gimbal
