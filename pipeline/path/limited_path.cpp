#include "pipeline/path/limited_path.hpp"

#include <utility>

namespace gimbal {

LimitedPath::LimitedPath(std::unique_ptr<PoseFilter> filter, ZoomChoice zoom, PathLatency latency)
    : filter_(std::move(filter)), limiter_(zoom, latency) {}

void LimitedPath::push(PathFrame frame) {
  filter_->push(frame.real);
  in_filter_.push_back(std::move(frame));
  limit_filtered();
}

void LimitedPath::finish() {
  filter_->finish();
  limit_filtered();
  limiter_.finish();
}

void LimitedPath::limit_filtered() {
  while (const auto steady = filter_->pop()) {
    PathFrame& frame = in_filter_.front();
    limiter_.push({frame.real, steady->q_world_camera, std::move(frame.required_zoom)});
    in_filter_.pop_front();
  }
}

}  // namespace gimbal
