#pragma once

#include <Eigen/Core>

#include "pipeline/estimator/error_state_filter.hpp"

namespace gimbal {

struct TiltWatchParameters {
  double memory_s = 10;
  /// Gained within the memory. Hands reach 5, a multirotor that flies to and fro or a car that
  /// brakes 20; where the tilt is wrong by 30 degrees, seven seconds seem to gain this.
  double largest_velocity_m_s = 25;
  double recent_s = 1;  ///< as long as the mean that shows the true tilt: it went wrong lately
  double realigned_sigma_rad = 0.2;  ///< a mean that short holds what the hand does meanwhile
};

/// Notices a tilt that is far from the truth, whatever the filter thinks of it: by the forces of
/// the last seconds the device would have gained a velocity that nothing with a camera on it gains.
/// A value: copy it to save it.
class TiltWatch {
 public:
  explicit TiltWatch(const TiltWatchParameters& parameters) : parameters_(parameters) {}

  /// Sums over the samples of a step, in world axes.
  void add(const ErrorStateFilter::Pending& step);

  [[nodiscard]] bool is_wrong() const;

  /// The mean of the last moments' forces, world axes.
  [[nodiscard]] const Eigen::Vector3d& recent_force_m_s2() const { return recent_force_m_s2_; }

 private:
  TiltWatchParameters parameters_;
  Eigen::Vector3d force_m_s_ = Eigen::Vector3d::Zero();
  double interval_s_ = 0;
  Eigen::Vector3d recent_force_m_s2_ = {0, 0, kGravity_m_s2};
};

}  // namespace gimbal
