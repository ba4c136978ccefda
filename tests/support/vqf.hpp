#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace gimbal {

/// Second-order Butterworth low-pass; its mean so far serves for the first time constant.
class ButterworthMean {
 public:
  ButterworthMean(double time_constant_s, double interval_s);
  Eigen::VectorXd operator()(const Eigen::VectorXd& value);

 private:
  double time_constant_s_;
  double interval_s_;
  double b0_;
  double a1_;
  double a2_;
  int count_ = 0;
  bool is_running_ = false;
  Eigen::VectorXd sum_;
  Eigen::VectorXd first_;
  Eigen::VectorXd second_;
};

/// The peer that orientations are compared with: VQF without a magnetometer, in real time, with its
/// published parameters, written after D. Laidig and T. Seel, "VQF: Highly Accurate IMU Orientation
/// Estimation with Bias Estimation and Magnetic Disturbance Rejection", Information Fusion 91
/// (2023), sections 3.2 to 3.5.
class Vqf {
 public:
  explicit Vqf(double interval_s);

  /// q_world_imu, world z up.
  Eigen::Quaterniond update(const Eigen::Vector3d& gyro_rad_s, const Eigen::Vector3d& accel_m_s2);

 private:
  void detect_rest(const Eigen::Vector3d& gyro_rad_s, const Eigen::Vector3d& accel_m_s2);
  void estimate_bias(const Eigen::Vector3d& up);

  double interval_s_;
  Eigen::Quaterniond strapdown_ = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond inclination_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d bias_rad_s_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d bias_covariance_;  ///< (0.01 deg/s)²
  Eigen::Vector3d rest_gyro_rad_s_ = Eigen::Vector3d::Zero();
  double rest_s_ = 0;
  bool is_resting_ = false;
  ButterworthMean accel_mean_;
  ButterworthMean rest_gyro_mean_;
  ButterworthMean rest_accel_mean_;
  ButterworthMean rotation_mean_;
  ButterworthMean world_bias_mean_;
};

}  // namespace gimbal
