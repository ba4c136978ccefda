#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "pipeline/path/camera_path.hpp"

namespace gimbal {

/// A steady view as the path wants it, and what the frame can show.
struct WantedView {
  FramePose real;
  Eigen::Quaterniond q_world_steady;
  RequiredZoom required_zoom;
};

/// Keeps views inside their frames: chooses the zoom, and where the zoom does not suffice turns the
/// view back towards the real camera, as little as needed, gradually.
///
/// When everything is known beforehand (latency none) the zoom is constant, and where the steady
/// view does not fit a less steady one takes its place: the real camera through a shorter and
/// shorter low-pass, gradually from frame to frame, so that its shake does not come back with it.
/// With a limited latency the zoom only ever grows, and a turn back is as sudden as the need for
/// it, its end gradual.
class ViewLimiter {
 public:
  ViewLimiter(ZoomChoice zoom, PathLatency latency);

  void push(WantedView view);
  void finish();
  [[nodiscard]] std::optional<SteadyView> pop();

 private:
  void fit_next(const WantedView& view);
  void fit_all();

  ZoomChoice choice_;
  PathLatency latency_;
  double zoom_;
  double last_share_ = 1;  ///< of the way from the real to the steady view, of the last frame
  std::vector<WantedView> held_;
  std::deque<SteadyView> ready_;
};

}  // namespace gimbal
