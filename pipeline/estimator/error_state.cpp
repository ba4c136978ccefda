#include "pipeline/estimator/error_state.hpp"

#include <cmath>

namespace gimbal {
namespace {

using Index = ErrorIndex;

void make_symmetric(ErrorCovariance& P, int index) {
  const Eigen::Matrix3d block = P.block<3, 3>(index, index);
  P.block<3, 3>(index, index) = 0.5 * (block + block.transpose());
}

}  // namespace

Eigen::Quaterniond rotation_from_vector(const Eigen::Vector3d& rotation_rad) {
  const double angle = rotation_rad.norm();
  // sin(x/2)/x, by its series where the quotient loses digits.
  const double k = angle < 1e-4 ? 0.5 - angle * angle / 48 : std::sin(angle / 2) / angle;
  const Eigen::Vector3d v = k * rotation_rad;
  return {std::cos(angle / 2), v.x(), v.y(), v.z()};
}

Eigen::Vector3d vector_from_rotation(const Eigen::Quaterniond& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

void InertialState::correct(const ErrorState& error) {
  q_world_imu =
      (rotation_from_vector(error.segment<3>(Index::attitude)) * q_world_imu).normalized();
  gyro_bias_rad_s += error.segment<3>(Index::gyro_bias);
  velocity_m_s += error.segment<3>(Index::velocity);
  accel_bias_m_s2 += error.segment<3>(Index::accel_bias);
  gyro_scale += error.segment<3>(Index::gyro_scale);
  accel_scale += error(Index::accel_scale);
}

void ErrorTransition::keep_velocity() {
  velocity_by_attitude.setZero();
  velocity_by_gyro_bias.setZero();
  velocity_by_gyro_scale.setZero();
  velocity_by_accel_bias.setZero();
  velocity_by_accel_scale.setZero();
}

void ErrorTransition::propagate(ErrorCovariance& P) const {
  if (!is_continuous) {
    P.middleRows<3>(Index::attitude).setZero();
    P.middleCols<3>(Index::attitude).setZero();
    P.middleRows<3>(Index::velocity).setZero();
    P.middleCols<3>(Index::velocity).setZero();
    return;
  }
  // Only the rows and columns of attitude and velocity change: first the columns of P Fᵀ ...
  using Columns = Eigen::Matrix<double, Index::size, 3>;
  const Columns by_gyro_bias = P.middleCols<3>(Index::gyro_bias);
  Columns attitude = P.middleCols<3>(Index::attitude);
  Columns velocity = P.middleCols<3>(Index::velocity);
  velocity.noalias() += attitude * velocity_by_attitude.transpose();
  velocity.noalias() += by_gyro_bias * velocity_by_gyro_bias.transpose();
  velocity.noalias() += P.middleCols<3>(Index::gyro_scale) * velocity_by_gyro_scale.transpose();
  velocity.noalias() += P.middleCols<3>(Index::accel_bias) * velocity_by_accel_bias.transpose();
  velocity.noalias() += P.col(Index::accel_scale) * velocity_by_accel_scale.transpose();
  attitude.noalias() += by_gyro_bias * attitude_by_gyro_bias.transpose();
  attitude.noalias() += P.middleCols<3>(Index::gyro_scale) * attitude_by_gyro_scale.transpose();
  // ... then their rows, and the rest by symmetry.
  for (Columns* columns : {&attitude, &velocity}) {
    const auto attitude_rows = columns->middleRows<3>(Index::attitude);
    const auto bias_rows = columns->middleRows<3>(Index::gyro_bias);
    const auto scale_rows = columns->middleRows<3>(Index::gyro_scale);
    const Eigen::Matrix3d velocity_rows =
        columns->middleRows<3>(Index::velocity) + velocity_by_attitude * attitude_rows +
        velocity_by_gyro_bias * bias_rows + velocity_by_gyro_scale * scale_rows +
        velocity_by_accel_bias * columns->middleRows<3>(Index::accel_bias) +
        velocity_by_accel_scale * columns->row(Index::accel_scale);
    columns->middleRows<3>(Index::attitude) +=
        attitude_by_gyro_bias * bias_rows + attitude_by_gyro_scale * scale_rows;
    columns->middleRows<3>(Index::velocity) = velocity_rows;
  }
  P.middleCols<3>(Index::attitude) = attitude;
  P.middleCols<3>(Index::velocity) = velocity;
  P.middleRows<3>(Index::velocity) = velocity.transpose();
  P.middleRows<3>(Index::attitude) = attitude.transpose();
  // Rounding must not make P lopsided where a block was computed twice.
  P.block<3, 3>(Index::velocity, Index::attitude) = attitude.middleRows<3>(Index::velocity);
  make_symmetric(P, Index::attitude);
  make_symmetric(P, Index::velocity);
}

MovingColumns ErrorTransition::back_from_attitude_and_velocity() const {
  MovingColumns back = MovingColumns::Zero();
  auto from_attitude = back.leftCols<3>();
  auto from_velocity = back.rightCols<3>();
  if (!is_continuous) {
    from_attitude.middleRows<3>(Index::attitude) = -Eigen::Matrix3d::Identity();
    from_velocity.middleRows<3>(Index::velocity) = -Eigen::Matrix3d::Identity();
    return back;
  }
  from_attitude.middleRows<3>(Index::gyro_bias) = attitude_by_gyro_bias.transpose();
  from_attitude.middleRows<3>(Index::gyro_scale) = attitude_by_gyro_scale.transpose();
  from_velocity.middleRows<3>(Index::attitude) = velocity_by_attitude.transpose();
  from_velocity.middleRows<3>(Index::gyro_bias) = velocity_by_gyro_bias.transpose();
  from_velocity.middleRows<3>(Index::gyro_scale) = velocity_by_gyro_scale.transpose();
  from_velocity.middleRows<3>(Index::accel_bias) = velocity_by_accel_bias.transpose();
  from_velocity.row(Index::accel_scale) = velocity_by_accel_scale.transpose();
  return back;
}

}  // namespace gimbal
