#include "pipeline/estimator/tilt_alignment.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/sample/attitude.hpp"
#include "pipeline/sample/upright.hpp"

namespace gimbal {
namespace {

// In free fall the specific force has no direction to start from.
constexpr double kSmallestForce_m_s2 = 0.1 * kGravity_m_s2;

constexpr double square(double x) {
  return x * x;
}

}  // namespace

void TiltAlignment::start(const Eigen::Vector3d& force_m_s2) {
  if (force_m_s2.norm() < kSmallestForce_m_s2) return;
  first_direction_ = force_m_s2.normalized();
}

void TiltAlignment::add(const ErrorStateFilter::Pending& step, double machine_velocity_m_s) {
  machine_velocity_m_s_ = machine_velocity_m_s;
  if (step.accel_interval_s <= 0) return;
  force_m_s_ += step.velocity_m_s;
  force_square_m2_s3_ += step.velocity_m_s.squaredNorm() / step.accel_interval_s;
  rotation_s_ += step.rotation_s;
  interval_s_ += step.accel_interval_s;
}

Eigen::Quaterniond TiltAlignment::turn_upright(const ErrorStateFilter::Pending& step) const {
  const double interval_s = interval_s_ + step.accel_interval_s;
  Eigen::Vector3d up = first_direction_ / square(parameters_.first_force_sigma_rad);
  if (interval_s > 0) {
    const Eigen::Vector3d mean = (force_m_s_ + step.velocity_m_s) / interval_s;
    if (mean.norm() > kSmallestForce_m_s2) {
      up += mean / kGravity_m_s2 / mean_variance_rad2(interval_s);
    }
  }
  return up.norm() > 0 ? gimbal::turn_upright(up) : Eigen::Quaterniond::Identity();
}

double TiltAlignment::accel_mean_square_m2_s4() const {
  if (interval_s_ == 0) return 0;
  return std::max(force_square_m2_s3_ / interval_s_ - (force_m_s_ / interval_s_).squaredNorm(),
                  0.0);
}

double TiltAlignment::velocity_variance_m2_s2() const {
  return square(parameters_.velocity_sigma_m_s) + square(machine_velocity_m_s_) +
         square(parameters_.velocity_by_accel_s) * accel_mean_square_m2_s4();
}

/// Of the mean of forces over so long: from beginning to end the velocity changes by two draws.
double TiltAlignment::mean_variance_rad2(double interval_s) const {
  return 2 * velocity_variance_m2_s2() / square(kGravity_m_s2 * interval_s);
}

double TiltAlignment::tilt_variance_rad2() const {
  double information = 0;
  if (has_started()) information += 1 / square(parameters_.first_force_sigma_rad);
  if (interval_s_ > 0) information += 1 / mean_variance_rad2(interval_s_);
  return 1 / (information + 1 / kUnknownAngle_rad2);
}

double TiltAlignment::velocity_tilt_covariance() const {
  // Half of the variance of the velocity's change is the last velocity's; the mean's error is that
  // change over g and the time, as far as the mean counts.
  const double weight = tilt_variance_rad2() / mean_variance_rad2(interval_s_);
  return weight * velocity_variance_m2_s2() / (kGravity_m_s2 * interval_s_);
}

bool TiltAlignment::is_done(double gyro_bias_variance_rad2_s2) const {
  if (force_m_s_.norm() <= kSmallestForce_m_s2 * interval_s_) return false;
  const double by_bias = gyro_bias_variance_rad2_s2 * square(interval_s_ / 2);
  return tilt_variance_rad2() <= std::max(square(parameters_.aligned_sigma_rad), by_bias) ||
         interval_s_ >= parameters_.longest_s;
}

}  // namespace gimbal
