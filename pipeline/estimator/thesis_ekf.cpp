#include "pipeline/estimator/thesis_ekf.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "pipeline/sample/upright.hpp"

namespace gimbal {
namespace {

// Well beyond the ranges of inertial sensors (about 70 rad/s and 2000 m/s²): what lies outside is
// no measurement, and would overflow in the filter.
constexpr double kLargestRate_rad_s = 1e3;
constexpr double kLargestAccel_m_s2 = 1e4;

// In free fall the specific force has no direction to start from.
constexpr double kSmallestAccelForTilt_m_s2 = 0.1 * kStandardGravity_m_s2;

/// False also for what is not a number.
bool is_within(const Eigen::Vector3d& value, double limit) {
  return value.norm() <= limit;
}

Eigen::Quaterniond to_quaternion(const QuaternionVector& q) {
  return {q(0), q(1), q(2), q(3)};
}

QuaternionVector to_vector(const Eigen::Quaterniond& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

}  // namespace

ThesisEkf::ThesisEkf(const ThesisEkfParameters& parameters) : parameters_(parameters) {
  restart_covariance();
}

Attitude ThesisEkf::update(const ImuSample& sample) {
  if (!is_within(sample.gyro_rad_s, kLargestRate_rad_s) || (last_ && sample.time <= last_->time)) {
    ++counts_.skipped_gyro;
    return predict(sample.time);
  }
  const SensorDuration interval = last_ ? sample.time - last_->time : SensorDuration::zero();
  advance_to(sample);
  if (sample.accel_m_s2) use_accel(*sample.accel_m_s2, interval);
  return {sample.time, to_quaternion(q_)};
}

void ThesisEkf::advance_to(const ImuSample& sample) {
  if (last_) {
    const SensorDuration interval = sample.time - last_->time;
    if (interval > parameters_.max_gap) {
      ++counts_.gaps;
      restart_covariance();
    } else if (parameters_.rate_hold == RateHold::previous) {
      time_update(last_->rate_rad_s, interval);
    } else {
      time_update(0.5 * (last_->rate_rad_s + sample.gyro_rad_s), interval);
    }
  }
  last_ = {sample.time, sample.gyro_rad_s};
}

void ThesisEkf::time_update(const Eigen::Vector3d& rate_rad_s, SensorDuration interval) {
  const auto [F, G] = discretize(parameters_.discretization, rate_rad_s, interval, q_);
  const double density = parameters_.gyro_noise_rad_s_rthz;
  const double Q = density * density / to_seconds(interval);  // times the identity
  P_ = F * P_ * F.transpose() + Q * G * G.transpose();
  q_ = (F * q_).normalized();
}

void ThesisEkf::use_accel(const Eigen::Vector3d& accel_m_s2, SensorDuration interval) {
  if (!is_within(accel_m_s2, kLargestAccel_m_s2)) {
    ++counts_.skipped_accel;
  } else if (!tilt_is_known_) {
    set_tilt(accel_m_s2);
  } else if (interval > SensorDuration::zero()) {
    measurement_update(accel_m_s2, interval);
  }
}

void ThesisEkf::set_tilt(const Eigen::Vector3d& accel_m_s2) {
  if (accel_m_s2.norm() < kSmallestAccelForTilt_m_s2) return;
  const Eigen::Quaterniond q = to_quaternion(q_);
  q_ = to_vector((turn_upright(q * accel_m_s2) * q).normalized());
  restart_covariance();
  tilt_is_known_ = true;
}

void ThesisEkf::measurement_update(const Eigen::Vector3d& accel_m_s2, SensorDuration interval) {
  const Eigen::Matrix<double, 3, 4> H = accel_jacobian(q_);
  const double density = parameters_.accel_noise_m_s2_rthz;
  const Eigen::Matrix3d R = density * density / to_seconds(interval) * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d S = H * P_ * H.transpose() + R;
  const Eigen::Matrix<double, 4, 3> K = P_ * H.transpose() * S.inverse();
  // P = (I - K H) P, written as P. D. Joseph's sum of squares (equal for this K), which rounding
  // keeps symmetric and positive semidefinite.
  const Eigen::Matrix4d kept = Eigen::Matrix4d::Identity() - K * H;
  P_ = kept * P_ * kept.transpose() + K * R * K.transpose();
  q_ = (q_ + K * (accel_m_s2 - accel_at_rest(q_))).normalized();
}

void ThesisEkf::restart_covariance() {
  // A quaternion changes by half the angle. It does not change along itself, where only its length
  // would, nor along what heading does to it: heading is arbitrary, so it starts without error.
  const double sigma = 0.5 * parameters_.initial_tilt_sigma_rad;
  const QuaternionVector along_heading(-q_(3), -q_(2), q_(1), q_(0));  // (0, 0, 0, 1) q
  P_ = sigma * sigma *
       (Eigen::Matrix4d::Identity() - q_ * q_.transpose() -
        along_heading * along_heading.transpose());
}

Attitude ThesisEkf::predict(SensorTime time) const {
  if (!last_ || time <= last_->time || time - last_->time > parameters_.max_gap) {
    return {time, to_quaternion(q_)};
  }
  const TimeStep step =
      discretize(parameters_.discretization, last_->rate_rad_s, time - last_->time, q_);
  return {time, to_quaternion((step.F * q_).normalized())};
}

}  // namespace gimbal
