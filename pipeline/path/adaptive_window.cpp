#include "pipeline/path/adaptive_window.hpp"

#include <algorithm>

namespace gimbal {

AdaptiveWindow::AdaptiveWindow(const AdaptiveHannParameters& parameters)
    : detector_(parameters.pan),
      wide_(half_of_window(parameters.wide_window)),
      narrow_(std::min(half_of_window(parameters.narrow_window), wide_)),
      half_width_(wide_) {}

void AdaptiveWindow::push(const FramePose& pose) {
  const std::size_t index = frames_seen_++;
  const auto began = detector_.update(pose.stamp.time, pose.q_world_camera);
  if (!began) return;
  // A change that crept in long ago is dated back by the narrow half width only: then no width
  // depends on what happens more than the wide half width ahead.
  const std::size_t back = std::min({*began, narrow_, index});
  mark_pan({index - back, index});
}

void AdaptiveWindow::mark_pan(const Pan& pan) {
  if (!pans_.empty() && pan.first_frame <= pans_.back().last_frame + 1) {
    pans_.back().first_frame = std::min(pans_.back().first_frame, pan.first_frame);
    pans_.back().last_frame = pan.last_frame;
  } else {
    pans_.push_back(pan);
  }
}

std::size_t AdaptiveWindow::half_width(std::size_t index) {
  forget_pans_before(index);
  const std::size_t target = std::min(wide_, narrow_ + frames_to_nearest_pan(index));
  const std::size_t one_narrower = half_width_ - std::min<std::size_t>(half_width_, 1);
  half_width_ = std::max(target, one_narrower);
  return half_width_;
}

std::size_t AdaptiveWindow::frames_to_nearest_pan(std::size_t index) const {
  std::size_t nearest = wide_;
  for (const Pan& pan : pans_) {
    const std::size_t until = pan.first_frame > index ? pan.first_frame - index : 0;
    const std::size_t since = index > pan.last_frame ? index - pan.last_frame : 0;
    nearest = std::min(nearest, std::max(until, since));
  }
  return nearest;
}

void AdaptiveWindow::forget_pans_before(std::size_t index) {
  while (!pans_.empty() && pans_.front().last_frame + wide_ < index) pans_.pop_front();
}

}  // namespace gimbal
