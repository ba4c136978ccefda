#include "tests/support/vqf.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace gimbal {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// Table 2 of the paper.
constexpr double kAccelTime_s = 3;
constexpr double kRestFilterTime_s = 0.5;
constexpr double kRestTime_s = 1.5;
constexpr double kRestGyro_rad_s = 2 * kDegree;
constexpr double kRestAccel_m_s2 = 0.5;
constexpr double kLargestBias_rad_s = 2 * kDegree;
constexpr double kBiasForgetting_s = 100;
constexpr double kVerticalForgetting = 1e-4;
// In 0.01 deg/s.
constexpr double kStartSigma = 50;
constexpr double kMotionSigma = 10;
constexpr double kRestSigma = 3;
constexpr double kGrownInForgetting = 10;

double square(double x) {
  return x * x;
}

double bias_growth(double interval_s) {
  return square(kGrownInForgetting) * interval_s / kBiasForgetting_s;
}

/// The measurement variance that leads to the given sigma in the long run.
double weight(double sigma, double growth) {
  return square(square(sigma)) / growth + square(sigma);
}

}  // namespace

ButterworthMean::ButterworthMean(double time_constant_s, double interval_s)
    : time_constant_s_(time_constant_s), interval_s_(interval_s) {
  // Cut-off at sqrt(2) / (2 pi tau), by the bilinear transform.
  const double c = std::tan(interval_s / (std::numbers::sqrt2 * time_constant_s));
  const double d = c * c + std::numbers::sqrt2 * c + 1;
  b0_ = c * c / d;
  a1_ = 2 * (c * c - 1) / d;
  a2_ = (1 - std::numbers::sqrt2 * c + c * c) / d;
}

Eigen::VectorXd ButterworthMean::operator()(const Eigen::VectorXd& value) {
  if (!is_running_) {
    sum_ = count_ == 0 ? value : Eigen::VectorXd(sum_ + value);
    ++count_;
    const Eigen::VectorXd mean = sum_ / count_;
    is_running_ = count_ * interval_s_ >= time_constant_s_;
    first_ = mean * (1 - b0_);
    second_ = mean * (b0_ - a2_);
    return mean;
  }
  Eigen::VectorXd filtered = b0_ * value + first_;
  first_ = 2 * b0_ * value - a1_ * filtered + second_;
  second_ = b0_ * value - a2_ * filtered;
  return filtered;
}

Vqf::Vqf(double interval_s)
    : interval_s_(interval_s),
      bias_covariance_(square(kStartSigma) * Eigen::Matrix3d::Identity()),
      accel_mean_(kAccelTime_s, interval_s),
      rest_gyro_mean_(kRestFilterTime_s, interval_s),
      rest_accel_mean_(kRestFilterTime_s, interval_s),
      rotation_mean_(kAccelTime_s, interval_s),
      world_bias_mean_(kAccelTime_s, interval_s) {}

Eigen::Quaterniond Vqf::update(const Eigen::Vector3d& gyro_rad_s,
                               const Eigen::Vector3d& accel_m_s2) {
  detect_rest(gyro_rad_s, accel_m_s2);
  const Eigen::Vector3d turn = (gyro_rad_s - bias_rad_s_) * interval_s_;
  strapdown_ =
      strapdown_ * Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()));
  strapdown_.normalize();
  const Eigen::Vector3d mean_force = accel_mean_(strapdown_ * accel_m_s2);
  const Eigen::Vector3d up = (inclination_ * mean_force).normalized();
  inclination_ = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()) * inclination_;
  inclination_.normalize();
  estimate_bias(up);
  return inclination_ * strapdown_;
}

void Vqf::detect_rest(const Eigen::Vector3d& gyro_rad_s, const Eigen::Vector3d& accel_m_s2) {
  rest_gyro_rad_s_ = rest_gyro_mean_(gyro_rad_s);
  const Eigen::Vector3d rest_accel = rest_accel_mean_(accel_m_s2);
  const bool moves = (gyro_rad_s - rest_gyro_rad_s_).norm() >= kRestGyro_rad_s ||
                     rest_gyro_rad_s_.cwiseAbs().maxCoeff() > kLargestBias_rad_s ||
                     (accel_m_s2 - rest_accel).norm() >= kRestAccel_m_s2;
  rest_s_ = moves ? 0 : rest_s_ + interval_s_;
  is_resting_ = rest_s_ >= kRestTime_s || (is_resting_ && !moves);
}

void Vqf::estimate_bias(const Eigen::Vector3d& up) {
  Eigen::Matrix3d R = (inclination_ * strapdown_).toRotationMatrix();
  const Eigen::Vector2d world_bias = world_bias_mean_((R * bias_rad_s_).head<2>());
  R = rotation_mean_(R.reshaped()).reshaped(3, 3);
  const double growth = bias_growth(interval_s_);
  Eigen::Vector3d error;
  Eigen::Vector3d variance;
  if (is_resting_) {
    error = rest_gyro_rad_s_ - bias_rad_s_;
    R.setIdentity();
    variance.setConstant(weight(kRestSigma, growth));
  } else {
    error = Eigen::Vector3d(-up.y() / interval_s_ + world_bias.x(),
                            up.x() / interval_s_ + world_bias.y(), 0) -
            R * bias_rad_s_;
    const double motion = weight(kMotionSigma, growth);
    variance << motion, motion, motion / kVerticalForgetting;
  }
  for (double& own : bias_covariance_.diagonal()) {
    if (own < square(kStartSigma)) own += growth;
  }
  error = error.cwiseMax(-kLargestBias_rad_s).cwiseMin(kLargestBias_rad_s);
  Eigen::Matrix3d S = R * bias_covariance_ * R.transpose();
  S.diagonal() += variance;
  const Eigen::Matrix3d K = bias_covariance_ * R.transpose() * S.inverse();
  bias_rad_s_ += K * error;
  bias_rad_s_ = bias_rad_s_.cwiseMax(-kLargestBias_rad_s).cwiseMin(kLargestBias_rad_s);
  bias_covariance_ -= (K * R * bias_covariance_).eval();
}

}  // namespace gimbal
