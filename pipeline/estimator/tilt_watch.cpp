#include "pipeline/estimator/tilt_watch.hpp"

#include <algorithm>
#include <cmath>

namespace gimbal {
namespace {

// In free fall no force shows a tilt.
constexpr double kSmallestForce_m_s2 = 0.1 * kGravity_m_s2;

}  // namespace

void TiltWatch::add(const ErrorStateFilter::Pending& step) {
  const double kept = std::exp(-step.interval_s / parameters_.memory_s);
  force_m_s_ = kept * force_m_s_ + step.velocity_m_s;
  interval_s_ = kept * interval_s_ + step.accel_interval_s;
  if (step.accel_interval_s <= 0) return;
  const double share = -std::expm1(-step.accel_interval_s / parameters_.recent_s);
  recent_force_m_s2_ += share * (step.velocity_m_s / step.accel_interval_s - recent_force_m_s2_);
}

bool TiltWatch::is_wrong() const {
  Eigen::Vector3d gained = force_m_s_ - Eigen::Vector3d(0, 0, kGravity_m_s2 * interval_s_);
  gained.z() = std::min(gained.z(), 0.0);  // a wrong tilt only takes from the force upwards
  return gained.norm() > parameters_.largest_velocity_m_s &&
         recent_force_m_s2_.norm() > kSmallestForce_m_s2;
}

}  // namespace gimbal
