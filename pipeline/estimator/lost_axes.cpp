#include "pipeline/estimator/lost_axes.hpp"

#include <algorithm>
#include <cmath>

namespace gimbal {

const AxisLosses& LostAxes::update(const Eigen::Vector3d& values, double interval_s) {
  const double forget = -std::expm1(-interval_s / parameters_.stuck_after_s);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    Axis& axis = axes_[i];
    const double value = values[static_cast<Eigen::Index>(i)];
    const double step = value - axis.value;
    axis.held_s = step == 0 ? axis.held_s + interval_s : 0;
    axis.step_variance += forget * (step * step - axis.step_variance);
    axis.value = value;
    axis.largest = std::max(axis.largest, std::abs(value));
  }
  for (std::size_t i = 0; i < losses_.size(); ++i) losses_[i] = loss_of(i);
  return losses_;
}

AxisLoss LostAxes::loss_of(std::size_t axis) const {
  const Axis& own = axes_[axis];
  if (own.held_s <= 0) return AxisLoss::none;
  const double magnitude = std::abs(own.value);
  if (magnitude >= own.largest && magnitude > parameters_.smallest_limit &&
      own.held_s > parameters_.clipped_after_s) {
    return AxisLoss::clipped;
  }
  double others = 0;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (i != axis) others = std::max(others, axes_[i].step_variance);
  }
  const bool is_stuck = own.held_s > parameters_.stuck_after_s &&
                        others > parameters_.others_move * parameters_.others_move;
  return is_stuck ? AxisLoss::stuck : AxisLoss::none;
}

}  // namespace gimbal
