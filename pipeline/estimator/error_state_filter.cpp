#include "pipeline/estimator/error_state_filter.hpp"

#include <cmath>

namespace gimbal {
namespace {

using Index = ErrorIndex;

/// [v]x, so that [v]x w = v x w.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace

void ErrorStateFilter::advance(const Eigen::Vector3d& gyro_rad_s,
                               const std::optional<Eigen::Vector3d>& accel_m_s2, double interval_s,
                               const IntervalNoise& noise) {
  const Eigen::Vector3d unbiased = gyro_rad_s - mean_.gyro_bias_rad_s;
  const Eigen::Vector3d rate = unbiased - mean_.gyro_scale.cwiseProduct(unbiased);
  const Eigen::Quaterniond half_turn = rotation_from_vector(0.5 * interval_s * rate);
  const Eigen::Quaterniond q_middle = mean_.q_world_imu * half_turn;
  mean_.q_world_imu = (q_middle * half_turn).normalized();

  const Eigen::Matrix3d R_dt = q_middle.toRotationMatrix() * interval_s;
  pending_.rotation_s += R_dt;
  pending_.rotation_by_rate_rad += R_dt * rate.asDiagonal();
  pending_.turn_rad += gyro_rad_s * interval_s;
  pending_.interval_s += interval_s;
  if (accel_m_s2) {
    const Eigen::Vector3d force = (1 - mean_.accel_scale) * (*accel_m_s2 - mean_.accel_bias_m_s2);
    const Eigen::Vector3d gained = R_dt * force;
    mean_.velocity_m_s += gained;
    mean_.velocity_m_s.z() -= kGravity_m_s2 * interval_s;
    pending_.velocity_m_s += gained;
    pending_.accel_interval_s += interval_s;
  }
  pending_.noise.attitude_rad2 += noise.attitude_rad2;
  pending_.noise.velocity_m2_s2 += noise.velocity_m2_s2;
}

ErrorTransition ErrorStateFilter::transition() const {
  const Eigen::Matrix3d gravity = cross_matrix({0, 0, kGravity_m_s2});
  const double fraction =
      pending_.interval_s > 0 ? pending_.accel_interval_s / pending_.interval_s : 0;
  ErrorTransition F;
  F.attitude_by_gyro_bias = -pending_.rotation_s;
  F.attitude_by_gyro_scale = -pending_.rotation_by_rate_rad;
  F.velocity_by_attitude = -pending_.accel_interval_s * gravity;
  // A bias or a scale turns the attitude evenly, so that on average half of the turn acts.
  F.velocity_by_gyro_bias = 0.5 * pending_.accel_interval_s * gravity * pending_.rotation_s;
  F.velocity_by_gyro_scale =
      0.5 * pending_.accel_interval_s * gravity * pending_.rotation_by_rate_rad;
  F.velocity_by_accel_bias = -fraction * pending_.rotation_s;
  F.velocity_by_accel_scale = -pending_.velocity_m_s;
  return F;
}

ErrorTransition ErrorStateFilter::close_step(const DriftNoise& noise) {
  ErrorTransition F = transition();
  F.propagate(P_);
  P_.block<3, 3>(Index::attitude, Index::attitude) += pending_.noise.attitude_rad2;
  const double T = pending_.interval_s;
  for (int i = 0; i < 3; ++i) {
    P_(Index::velocity + i, Index::velocity + i) += pending_.noise.velocity_m2_s2;
    P_(Index::gyro_bias + i, Index::gyro_bias + i) +=
        noise.gyro_bias_rad_s_rts * noise.gyro_bias_rad_s_rts * T;
    P_(Index::accel_bias + i, Index::accel_bias + i) +=
        noise.accel_bias_m_s2_rts * noise.accel_bias_m_s2_rts * T;
  }
  pending_ = {};
  return F;
}

ScalarUpdate ErrorStateFilter::measure(int index, double residual, double noise_variance) {
  ScalarUpdate update;
  update.index = index;
  update.residual = residual;
  update.variance = P_(index, index) + noise_variance;
  // Scaled so that the product below is symmetric to the bit.
  const double sigma = std::sqrt(update.variance);
  const ErrorState scaled = P_.col(index) / sigma;
  update.gain = scaled / sigma;
  P_.noalias() -= scaled * scaled.transpose();
  mean_.correct(update.gain * residual);
  return update;
}

Eigen::Matrix3d ErrorStateFilter::attitude_covariance() const {
  const ErrorTransition F = transition();
  const Eigen::Matrix3d attitude = P_.block<3, 3>(Index::attitude, Index::attitude);
  const Eigen::Matrix3d cross =
      F.attitude_by_gyro_bias * P_.block<3, 3>(Index::gyro_bias, Index::attitude) +
      F.attitude_by_gyro_scale * P_.block<3, 3>(Index::gyro_scale, Index::attitude);
  const Eigen::Matrix3d bias_and_scale = F.attitude_by_gyro_bias *
                                         P_.block<3, 3>(Index::gyro_bias, Index::gyro_scale) *
                                         F.attitude_by_gyro_scale.transpose();
  return attitude + cross + cross.transpose() + bias_and_scale + bias_and_scale.transpose() +
         F.attitude_by_gyro_bias * P_.block<3, 3>(Index::gyro_bias, Index::gyro_bias) *
             F.attitude_by_gyro_bias.transpose() +
         F.attitude_by_gyro_scale * P_.block<3, 3>(Index::gyro_scale, Index::gyro_scale) *
             F.attitude_by_gyro_scale.transpose() +
         pending_.noise.attitude_rad2;
}

}  // namespace gimbal
