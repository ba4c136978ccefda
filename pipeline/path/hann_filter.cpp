#include "pipeline/path/hann_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace gimbal {

double hann_weight(std::size_t distance, std::size_t half_width) {
  if (half_width == 0) return distance == 0 ? 1 : 0;
  const double fraction = static_cast<double>(distance) / static_cast<double>(half_width);
  return 0.5 * (1 + std::cos(std::numbers::pi * fraction));
}

HannFilter::HannFilter(std::unique_ptr<WindowSize> window, PathLatency latency)
    : window_(std::move(window)), latency_(latency.value_or(window_->largest_half_width())) {}

void HannFilter::push(const FramePose& pose) {
  FramePose consistent = pose;
  if (!poses_.empty() && poses_.back().q_world_camera.dot(pose.q_world_camera) < 0) {
    consistent.q_world_camera.coeffs() *= -1;
  }
  poses_.push_back(consistent);
  ++pushed_;
  window_->push(consistent);
  // At once, not in `pop`: what was pushed later must not matter.
  if (pushed_ - released_ > latency_) release_next();
}

void HannFilter::finish() {
  while (released_ < pushed_) release_next();
}

std::optional<FramePose> HannFilter::pop() {
  if (ready_.empty()) return std::nullopt;
  FramePose next = ready_.front();
  ready_.pop_front();
  return next;
}

void HannFilter::release_next() {
  const std::size_t index = released_++;
  const Reach reach = reach_at(index, pushed_ - 1 - index);
  ready_.push_back({pose(index).stamp, mean_around(index, reach)});
  while (first_held_ + window_->largest_half_width() < released_) {
    poses_.pop_front();
    ++first_held_;
  }
}

HannFilter::Reach HannFilter::reach_at(std::size_t index, std::size_t frames_ahead) {
  const std::size_t half_width = std::min(window_->half_width(index), index);
  const std::size_t ahead = std::min(half_width, frames_ahead);
  const bool sees_whole_window = latency_ >= window_->largest_half_width();
  return sees_whole_window ? Reach{ahead, ahead} : Reach{half_width, ahead};
}

Eigen::Quaterniond HannFilter::mean_around(std::size_t index, const Reach& reach) const {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (std::size_t n = 0; n <= reach.half_width; ++n) {
    const double weight = hann_weight(n, reach.half_width);
    sum += weight * pose(index - n).q_world_camera.coeffs();
    if (n > 0 && n <= reach.ahead) sum += weight * pose(index + n).q_world_camera.coeffs();
  }
  // Turned all round within the window, poses can cancel out: there is no mean then.
  constexpr double kSmallestNorm = 1e-6;
  if (sum.norm() < kSmallestNorm) return pose(index).q_world_camera;
  return Eigen::Quaterniond(sum.normalized());
}

const FramePose& HannFilter::pose(std::size_t index) const {
  return poses_[index - first_held_];
}

}  // namespace gimbal
