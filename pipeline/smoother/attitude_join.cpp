#include "pipeline/smoother/attitude_join.hpp"

#include <algorithm>
#include <numbers>

namespace gimbal {
namespace {

/// Too slow to be seen, or to bend the rows of a frame.
constexpr double kFading_rad_s = 2 * std::numbers::pi / 180;

/// The part of a rotation that turns about world z ("twist").
Eigen::Quaterniond about_vertical(const Eigen::Quaterniond& q) {
  const Eigen::Quaterniond twist(q.w(), 0, 0, q.z());
  // A half turn about a horizontal axis has none.
  return twist.norm() > 0 ? twist.normalized() : Eigen::Quaterniond::Identity();
}

}  // namespace

void AttitudeJoin::join(const Eigen::Quaterniond& held, const Attitude& next) {
  const Eigen::Quaterniond turn = held * next.q_world_imu.conjugate();
  heading_ = about_vertical(turn);
  tilt_ = Eigen::AngleAxisd(turn * heading_.conjugate());
  last_ = next.time;
}

Attitude AttitudeJoin::turned(const Attitude& attitude) {
  const double faded_rad = kFading_rad_s * to_seconds(attitude.time - last_);
  tilt_.angle() = std::max(0.0, tilt_.angle() - faded_rad);
  last_ = attitude.time;
  return {attitude.time, (tilt_ * heading_ * attitude.q_world_imu).normalized()};
}

AttitudeEstimate AttitudeJoin::turned(const AttitudeEstimate& estimate) {
  AttitudeEstimate shown{turned(estimate.attitude), estimate.covariance_rad2, estimate.origin};
  const Eigen::Matrix3d R = (tilt_ * heading_).toRotationMatrix();
  const Eigen::Vector3d tilt_error = tilt_.angle() * tilt_.axis();
  shown.covariance_rad2 = R * estimate.covariance_rad2 * R.transpose();
  shown.covariance_rad2 += tilt_error * tilt_error.transpose();
  return shown;
}

}  // namespace gimbal
