#include "pipeline/path/view_limiter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "pipeline/path/view_fit.hpp"

namespace gimbal {
namespace {

using Eigen::Quaterniond;

/// How fast a view may approach the steady one again, as share of the way a frame: a third of a
/// second at 30 fps for all of it.
constexpr double kShareStep = 0.1;

/// Half widths of the low-passes that take the steady view's place, from the steadiest to the real
/// camera itself.
constexpr std::array<double, 9> kHalfWidths_s = {1.2, 0.9, 0.7, 0.5, 0.37, 0.27, 0.2, 0.13, 0};

/// How fast one low-pass may give way to the next, in steps a frame: two thirds of a second at 30
/// fps for each. A faster change is a jerk that the camera never made.
constexpr double kLevelStep = 0.05;

double needed(const WantedView& view, const Quaterniond& q_world_camera) {
  return needed_zoom(view.required_zoom, q_world_camera);
}

double share_that_fits(const WantedView& view, const Quaterniond& q_world_camera, double zoom) {
  return fitting_share(view.required_zoom, view.real.q_world_camera, q_world_camera, zoom);
}

/// The view nearest to `q_world_camera` that fits, on the way from the real one.
Quaterniond fitted(const WantedView& view, const Quaterniond& q_world_camera, double zoom) {
  const double share = share_that_fits(view, q_world_camera, zoom);
  return view.real.q_world_camera.slerp(share, q_world_camera);
}

/// The real camera through a Hann low-pass (thesis 2.33, 2.34).
Quaterniond low_passed(const std::vector<WantedView>& views, std::size_t center,
                       double half_width_s) {
  const FramePose& middle = views[center].real;
  Eigen::Vector4d sum = middle.q_world_camera.coeffs();
  const auto add = [&](std::size_t i) {
    const FramePose& pose = views[i].real;
    const double phase = to_seconds(pose.stamp.time - middle.stamp.time) / half_width_s;
    if (!(std::abs(phase) < 1)) return false;
    const double sign = pose.q_world_camera.dot(middle.q_world_camera) < 0 ? -1 : 1;
    sum += sign * 0.5 * (1 + std::cos(std::numbers::pi * phase)) * pose.q_world_camera.coeffs();
    return true;
  };
  // As far to the one side as to the other, or a pan would be pulled inwards at the ends.
  for (std::size_t i = 1; i <= center && center + i < views.size(); ++i) {
    if (!add(center - i) || !add(center + i)) break;
  }
  return Quaterniond(sum.normalized());
}

/// The steady view (level 0), or a less steady one: from level 1 on the low-passes in order, levels
/// between two of them in part.
Quaterniond at_level(const std::vector<WantedView>& views, std::size_t i, double level) {
  const auto whole = [&](double whole_level) {
    const auto index = static_cast<std::size_t>(whole_level);
    return index == 0 ? views[i].q_world_steady : low_passed(views, i, kHalfWidths_s[index - 1]);
  };
  const double below = std::floor(level);
  const Quaterniond q = whole(below);
  return level == below ? q : q.slerp(level - below, whole(below + 1));
}

/// The first whole level that fits at `zoom`; the last, the real camera, if none does. Where the
/// real view is what is wanted, nothing takes its place.
double fitting_level(const std::vector<WantedView>& views, std::size_t i, double zoom) {
  constexpr double kSame_rad = 1e-6;
  const WantedView& view = views[i];
  if (view.q_world_steady.angularDistance(view.real.q_world_camera) < kSame_rad) return 0;
  double level = 0;
  while (level < kHalfWidths_s.size() && needed(view, at_level(views, i, level)) > zoom) ++level;
  return level;
}

/// Raises levels so that neighbours differ by no more than a step.
void raise_gradually(std::vector<double>& levels) {
  for (std::size_t i = 1; i < levels.size(); ++i) {
    levels[i] = std::max(levels[i], levels[i - 1] - kLevelStep);
  }
  for (std::size_t i = levels.size(); i-- > 1;) {
    levels[i - 1] = std::max(levels[i - 1], levels[i] - kLevelStep);
  }
}

}  // namespace

ViewLimiter::ViewLimiter(ZoomChoice zoom, PathLatency latency)
    : choice_(zoom), latency_(latency), zoom_(zoom.least) {}

void ViewLimiter::push(WantedView view) {
  if (latency_) {
    fit_next(view);
  } else {
    held_.push_back(std::move(view));
  }
}

void ViewLimiter::fit_next(const WantedView& view) {
  zoom_ = std::clamp(needed(view, view.q_world_steady), zoom_, choice_.most);
  last_share_ =
      std::min(share_that_fits(view, view.q_world_steady, zoom_), last_share_ + kShareStep);
  ready_.push_back(
      {{view.real.stamp, view.real.q_world_camera.slerp(last_share_, view.q_world_steady)}, zoom_});
}

void ViewLimiter::fit_all() {
  for (const WantedView& view : held_) {
    zoom_ = std::clamp(needed(view, view.q_world_steady), zoom_, choice_.most);
  }
  std::vector<double> levels;
  levels.reserve(held_.size());
  for (std::size_t i = 0; i < held_.size(); ++i) levels.push_back(fitting_level(held_, i, zoom_));
  raise_gradually(levels);
  for (std::size_t i = 0; i < held_.size(); ++i) {
    // A view between two that fit, or a steadier frame's neighbour, may still not fit.
    const Quaterniond q = fitted(held_[i], at_level(held_, i, levels[i]), zoom_);
    ready_.push_back({{held_[i].real.stamp, q}, zoom_});
  }
  held_.clear();
}

void ViewLimiter::finish() {
  fit_all();
}

std::optional<SteadyView> ViewLimiter::pop() {
  if (ready_.empty()) return std::nullopt;
  SteadyView view = std::move(ready_.front());
  ready_.pop_front();
  return view;
}

}  // namespace gimbal
