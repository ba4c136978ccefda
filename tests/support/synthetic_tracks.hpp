#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "drivers/synthetic/hand_motion.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sync/joint_fit.hpp"

namespace gimbal::test {

/// A camera that is carried about, its IMU, and what both get wrong.
struct TrackScenario {
  CameraCalibration camera;  ///< the truth; its time_offset is that of the stamps
  Eigen::Matrix3d M_camera_imu = Eigen::Matrix3d::Identity();  ///< w_camera = M w_imu
  HandModel hand = walking_hand();
  SensorDuration duration = std::chrono::seconds(60);
  double gyro_rate_hz = 400;
  double gyro_noise_rad_s = 1e-4;  ///< a √Hz
  Eigen::Vector3d gyro_bias_rad_s = {0.012, -0.02, 0.008};
  int corners = 80;
  double corner_noise_px = 0.2;
  double moving_share = 0;  ///< of the corners, on objects that move on their own
  double hand_sway_m = 0;   ///< rms along each axis, at 0.2 to 2 Hz
  double nearest_m = 3;     ///< how far away things are, evenly in the logarithm
  double farthest_m = 60;
  std::uint64_t seed = 1;
};

/// 1280x720 at 30 Hz, 55 degrees wide.
[[nodiscard]] CameraCalibration camera_720p(SensorDuration readout);

/// What a tracker would see and a gyroscope feel: corners projected through the true camera, each
/// in its own row's instant. The camera of the result is the true one.
[[nodiscard]] JointData make_tracks(const TrackScenario& scenario);

}  // namespace gimbal::test
