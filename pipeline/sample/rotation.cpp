#include "pipeline/sample/rotation.hpp"

#include <cmath>

namespace gimbal {

Eigen::Quaterniond quaternion_exp(const Eigen::Vector3d& rotation_vector) {
  const double half_angle = 0.5 * rotation_vector.norm();
  // sin(x)/x by its series where the division would lose all digits.
  const double sinc =
      half_angle < 1e-4 ? 1.0 - half_angle * half_angle / 6.0 : std::sin(half_angle) / half_angle;
  Eigen::Quaterniond q;
  q.w() = std::cos(half_angle);
  q.vec() = 0.5 * sinc * rotation_vector;
  return q;
}

Eigen::Vector3d quaternion_log(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const double sine = q.vec().norm();
  if (sine < 1e-9) return 2.0 * sign * q.vec();
  return 2.0 * sign * std::atan2(sine, sign * q.w()) / sine * q.vec();
}

}  // namespace gimbal
