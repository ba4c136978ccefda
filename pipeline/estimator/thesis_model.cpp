#include "pipeline/estimator/thesis_model.hpp"

#include <cmath>

namespace gimbal {

Eigen::Matrix4d rate_matrix(const Eigen::Vector3d& rate_rad_s) {
  const double x = rate_rad_s.x();
  const double y = rate_rad_s.y();
  const double z = rate_rad_s.z();
  Eigen::Matrix4d S1;
  S1 << 0, -x, -y, -z,  //
      x, 0, z, -y,      //
      y, -z, 0, x,      //
      z, y, -x, 0;
  return S1;
}

Eigen::Matrix<double, 4, 3> quaternion_matrix(const QuaternionVector& q) {
  Eigen::Matrix<double, 4, 3> S2;
  S2 << -q(1), -q(2), -q(3),  //
      q(0), -q(3), q(2),      //
      q(3), q(0), -q(1),      //
      -q(2), q(1), q(0);
  return S2;
}

TimeStep discretize(Discretization discretization, const Eigen::Vector3d& rate_rad_s,
                    SensorDuration interval, const QuaternionVector& q) {
  const double half_interval = 0.5 * to_seconds(interval);
  double cosine = 1;
  double sine_over_rate = half_interval;  // also the limit of the exact form at no rate
  const double rate = rate_rad_s.norm();
  if (discretization == Discretization::exact && rate > 0) {
    cosine = std::cos(rate * half_interval);
    sine_over_rate = std::sin(rate * half_interval) / rate;
  }
  return {cosine * Eigen::Matrix4d::Identity() + sine_over_rate * rate_matrix(rate_rad_s),
          sine_over_rate * quaternion_matrix(q)};
}

Eigen::Vector3d accel_at_rest(const QuaternionVector& q) {
  return kStandardGravity_m_s2 *
         Eigen::Vector3d(2 * (q(1) * q(3) - q(0) * q(2)), 2 * (q(2) * q(3) + q(0) * q(1)),
                         q(0) * q(0) - q(1) * q(1) - q(2) * q(2) + q(3) * q(3));
}

Eigen::Matrix<double, 3, 4> accel_jacobian(const QuaternionVector& q) {
  Eigen::Matrix<double, 3, 4> H;
  H << -q(2), q(3), -q(0), q(1),  //
      q(1), q(0), q(3), q(2),     //
      q(0), -q(1), -q(2), q(3);
  return 2 * kStandardGravity_m_s2 * H;
}

}  // namespace gimbal
