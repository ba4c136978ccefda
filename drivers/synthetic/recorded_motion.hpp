#pragma once

#include <Eigen/Core>
#include <vector>

#include "drivers/synthetic/motion.hpp"
#include "pipeline/sample/imu_sample.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// What an IMU logged while it was carried about.
struct MotionLog {
  std::vector<GyroSample> gyro;    ///< stamps rise
  std::vector<AccelSample> accel;  ///< may be empty: then the camera starts level
  Eigen::Matrix3d R_camera_imu = Eigen::Matrix3d::Identity();
};

/// A motion like the logged one, for `duration` from `start` after the first gyro sample. Its time
/// zero is at `start`, and the camera's heading then is the world's x. It begins a little earlier
/// and ends a little later, as far as the log goes.
///
/// The gyro's rates are integrated. Its bias and the initial inclination are those with which the
/// logged specific force, turned into the world, is gravity on average. What then remains of the
/// specific force is the hand's acceleration, less its slow part: a hand stays where it is.
/// Refuses a log without two gyro samples and a stretch that the log does not hold.
[[nodiscard]] Result<Motion> make_recorded_motion(const MotionLog& log, SensorDuration start,
                                                  SensorDuration duration);

}  // namespace gimbal
