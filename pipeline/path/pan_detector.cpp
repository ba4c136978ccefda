#include "pipeline/path/pan_detector.hpp"

#include <algorithm>

#include "pipeline/sample/rotation.hpp"

namespace gimbal {

PanDetector::PanDetector(const PanDetectorParameters& parameters) : parameters_(parameters) {}

std::optional<std::size_t> PanDetector::update(SensorTime time,
                                               const Eigen::Quaterniond& q_world_camera) {
  const Pose now{time, q_world_camera};
  const Pose before = last_.value_or(now);
  last_ = now;
  const Eigen::Vector3d turn_rad =
      quaternion_log(before.q_world_camera.conjugate() * q_world_camera);
  const double allowance_rad = parameters_.held_rate_rad_s * to_seconds(time - before.time);

  std::optional<std::size_t> began;
  for (std::size_t i = 0; i < tests_.size(); ++i) {
    const double turn = turn_rad(static_cast<Eigen::Index>(i / 2)) * (i % 2 == 0 ? 1 : -1);
    tests_[i].add(turn - allowance_rad, parameters_.excess_angle_rad);
    began = std::max(began, tests_[i].frames_since_change());
  }
  return began;
}

void PanDetector::OneSidedTest::add(double excess_rad, double threshold_rad) {
  sum_rad_ = std::clamp(sum_rad_ + excess_rad, 0.0, threshold_rad);
  frames_above_zero_ = sum_rad_ > 0 ? frames_above_zero_ + 1 : 0;
  if (sum_rad_ == 0) alarm_ = false;
  if (sum_rad_ >= threshold_rad && threshold_rad > 0) alarm_ = true;
}

std::optional<std::size_t> PanDetector::OneSidedTest::frames_since_change() const {
  if (!alarm_) return std::nullopt;
  return frames_above_zero_;
}

}  // namespace gimbal
