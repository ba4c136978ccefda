#include "pipeline/smoother/gradual_correction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/sample/rotation.hpp"

namespace gimbal {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Over a longer hole the gyroscope leads nowhere.
constexpr double kLongestBridge_s = 0.1;

constexpr double kShareOfAge = 1;

/// Slow enough that nobody sees the picture turn with what the filter finds out, above all in its
/// first moments; level within seconds all the same.
constexpr double kFastest_rad_s = 4 * std::numbers::pi / 180;

}  // namespace

Quaterniond GradualCorrection::follow(const Attitude& estimate, const Vector3d& rate_rad_s) {
  Quaterniond shown = estimate.q_world_imu;
  if (last_) {
    const double interval_s = to_seconds(estimate.time - last_->attitude.time);
    if (interval_s <= kLongestBridge_s) {
      const Vector3d mean_rad_s = (last_->rate_rad_s + rate_rad_s) / 2;
      const Quaterniond led = last_->attitude.q_world_imu * quaternion_exp(interval_s * mean_rad_s);
      age_s_ += interval_s;
      const double memory_s = std::min(memory_s_, kShareOfAge * age_s_);
      const double off_rad = led.angularDistance(estimate.q_world_imu);
      double share = -std::expm1(-interval_s / memory_s);
      if (share * off_rad > kFastest_rad_s * interval_s)
        share = kFastest_rad_s * interval_s / off_rad;
      shown = led.slerp(share, estimate.q_world_imu).normalized();
    } else {
      age_s_ = 0;
    }
  }
  last_ = Shown{{estimate.time, shown}, rate_rad_s};
  return shown;
}

}  // namespace gimbal
