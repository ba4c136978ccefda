#pragma once

#include "pipeline/sample/attitude.hpp"
#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {

/// Orientation from inertial samples, one at a time. No I/O, no clock, no threads.
class Estimator {
 public:
  Estimator() = default;
  Estimator(const Estimator&) = delete;
  Estimator& operator=(const Estimator&) = delete;
  virtual ~Estimator() = default;

  /// Takes the next sample (stamps rise strictly) and answers for its instant.
  virtual Attitude update(const ImuSample& sample) = 0;
};

}  // namespace gimbal
