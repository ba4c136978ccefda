#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "pipeline/path/camera_path.hpp"
#include "pipeline/path/pose_filter.hpp"
#include "pipeline/path/view_limiter.hpp"

namespace gimbal {

/// A low-pass that knows nothing of the frames, and behind it what keeps its views inside of them.
class LimitedPath final : public CameraPath {
 public:
  LimitedPath(std::unique_ptr<PoseFilter> filter, ZoomChoice zoom, PathLatency latency);

  void push(PathFrame frame) override;
  void finish() override;
  [[nodiscard]] std::optional<SteadyView> pop() override { return limiter_.pop(); }

 private:
  void limit_filtered();

  std::unique_ptr<PoseFilter> filter_;
  ViewLimiter limiter_;
  std::deque<PathFrame> in_filter_;
};

}  // namespace gimbal
