#pragma once

#include <Eigen/Core>
#include <vector>

#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/imu_sample.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sync/feature_track.hpp"
#include "pipeline/sync/sighting.hpp"

namespace gimbal {

/// All that makes the gyroscope explain the picture.
struct JointParameters {
  double offset_s = 0;   ///< added to stamps to get the IMU's clock
  double readout_s = 0;  ///< below zero: against the direction of the calibration
  Eigen::Matrix3d R_camera_imu = Eigen::Matrix3d::Identity();
  Eigen::Vector3d gyro_bias_rad_s = Eigen::Vector3d::Zero();
  double focal_scale = 1;  ///< of the calibration's focal lengths
};

/// Where each lies in the covariance. The rotation's error is a rotation vector in camera axes.
struct JointIndex {
  enum : int { offset_s = 0, readout_s = 1, axes_rad = 2, bias_rad_s = 5, log_focal = 8, size = 9 };
};

using JointCovariance = Eigen::Matrix<double, JointIndex::size, JointIndex::size>;

struct JointFit {
  JointParameters parameters;
  JointCovariance covariance;
  double noise_px = 0;    ///< of one coordinate of a pair's difference, robust
  std::size_t pairs = 0;  ///< compared
  double agreeing = 0;    ///< share of these within three times the noise
};

/// What the fit compares: what was seen, and what was felt.
struct JointData {
  CameraCalibration camera;
  std::vector<FrameStamp> frames;
  std::vector<FeatureTrack> tracks;
  std::vector<GyroSample> gyro;
};

/// Turns each corner by what the gyroscope felt between the instants of its two rows and compares
/// it with where it was seen (thesis 2.37 to 2.39), all parameters at once, by least squares that
/// count outliers little (Cauchy). As if everything were far away.
///
/// The covariance allows for errors that last (a hand that moves aside, an object that passes): it
/// adds up scores over stretches of time (the clustered sandwich of Liang and Zeger, Biometrika 73,
/// 1986), so that many corners of one moment do not count as so many witnesses.
[[nodiscard]] Result<JointFit> fit_jointly(const JointData& data, const JointParameters& start);

}  // namespace gimbal
