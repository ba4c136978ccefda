#include "pipeline/path/view_fade.hpp"

#include <cmath>

#include "pipeline/path/view_fit.hpp"
#include "pipeline/sample/smooth_step.hpp"

namespace gimbal {
namespace {

constexpr double kFade_s = 1.5;

}  // namespace

void ViewFade::begin(const SteadyView& shown, const SteadyView& instead) {
  since_ = shown.steady.stamp.time;
  turn_ = shown.steady.q_world_camera * instead.steady.q_world_camera.conjugate();
  zoom_ratio_ = shown.zoom / instead.zoom;
}

SteadyView ViewFade::faded(const SteadyView& view, const PathFrame& frame) const {
  if (!since_) return view;
  const double left = 1 - smooth_step(to_seconds(view.steady.stamp.time - *since_) / kFade_s);
  if (left <= 0) return view;
  SteadyView faded = view;
  faded.zoom = view.zoom * std::pow(zoom_ratio_, left);
  Eigen::Quaterniond& q_world_view = faded.steady.q_world_camera;
  q_world_view = Eigen::Quaterniond::Identity().slerp(left, turn_) * q_world_view;
  const Eigen::Quaterniond& real = frame.real.q_world_camera;
  const double share = fitting_share(frame.required_zoom, real, q_world_view, faded.zoom);
  if (share < 1) q_world_view = real.slerp(share, q_world_view);
  return faded;
}

}  // namespace gimbal
