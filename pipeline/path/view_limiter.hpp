#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "pipeline/path/camera_path.hpp"

namespace gimbal {

/// The zoom at which a view in the given direction, q_world_camera, shows no border; infinite if
/// none does.
using RequiredZoom = std::function<double(const Eigen::Quaterniond&)>;

/// A steady view as the path wants it, and what the frame can show.
struct WantedView {
  FramePose real;
  Eigen::Quaterniond q_world_steady;
  RequiredZoom required_zoom;
};

/// A view that fits its frame as far as any does.
struct FittedView {
  FramePose steady;
  double zoom = 1;
};

/// Either a zoom for all frames, or the least that is needed up to a limit.
struct ZoomChoice {
  double least = 1;
  double most = 1;
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
  [[nodiscard]] std::optional<FittedView> pop();

 private:
  void fit_next(const WantedView& view);
  void fit_all();

  ZoomChoice choice_;
  PathLatency latency_;
  double zoom_;
  double last_share_ = 1;  ///< of the way from the real to the steady view, of the last frame
  std::vector<WantedView> held_;
  std::deque<FittedView> ready_;
};

}  // namespace gimbal
