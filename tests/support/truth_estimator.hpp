#pragma once

#include "drivers/synthetic/motion.hpp"
#include "pipeline/estimator/estimator.hpp"
#include "pipeline/sample/calibration.hpp"

namespace gimbal::test {

/// Knows the orientation. `motion` has to stay.
class TruthEstimator final : public Estimator {
 public:
  TruthEstimator(const Motion& motion, const ImuCalibration& imu)
      : motion_(motion), q_camera_imu_(imu.R_camera_imu) {}

  Attitude update(const ImuSample& sample) override {
    return {sample.time, motion_.at(sample.time).q_world_camera * q_camera_imu_};
  }

 private:
  const Motion& motion_;
  Eigen::Quaterniond q_camera_imu_;
};

}  // namespace gimbal::test
