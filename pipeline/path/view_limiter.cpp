#include "pipeline/path/view_limiter.hpp"

#include <algorithm>
#include <utility>

namespace gimbal {
namespace {

/// A mesh is affine between its vertices, the outline is its edge: this much more zoom covers what
/// rounding could uncover.
constexpr double kZoomMargin = 1.0005;

/// How fast a view may leave or approach the steady one, as share of the way a frame: a third of a
/// second at 30 fps for all of it.
constexpr double kShareStep = 0.1;

Eigen::Quaterniond part_way(const WantedView& view, double share) {
  return view.real.q_world_camera.slerp(share, view.q_world_steady);
}

double needed(const WantedView& view, double share) {
  return view.required_zoom(part_way(view, share)) * kZoomMargin;
}

/// The largest share of the way to the steady view that fits at `zoom`; 0 if not even the real one
/// does.
double fitting_share(const WantedView& view, double zoom) {
  if (needed(view, 1) <= zoom) return 1;
  double fits = 0;
  double does_not = 1;
  constexpr int kHalvings = 10;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (fits + does_not) / 2;
    (needed(view, middle) <= zoom ? fits : does_not) = middle;
  }
  return fits;
}

}  // namespace

ViewLimiter::ViewLimiter(ZoomChoice zoom, PathLatency latency)
    : choice_(zoom), latency_(latency), zoom_(zoom.least) {}

void ViewLimiter::push(WantedView view) {
  if (!latency_) {
    held_.push_back(std::move(view));
    return;
  }
  zoom_ = std::clamp(needed(view, 1), zoom_, choice_.most);
  release(view, std::min(fitting_share(view, zoom_), last_share_ + kShareStep));
}

void ViewLimiter::release(const WantedView& view, double share) {
  last_share_ = share;
  ready_.push_back({{view.real.stamp, part_way(view, share)}, zoom_});
}

void ViewLimiter::release_all() {
  for (const WantedView& view : held_) {
    zoom_ = std::clamp(needed(view, 1), zoom_, choice_.most);
  }
  std::vector<double> shares;
  shares.reserve(held_.size());
  for (const WantedView& view : held_) shares.push_back(fitting_share(view, zoom_));
  for (std::size_t i = 1; i < shares.size(); ++i) {
    shares[i] = std::min(shares[i], shares[i - 1] + kShareStep);
  }
  for (std::size_t i = shares.size(); i-- > 1;) {
    shares[i - 1] = std::min(shares[i - 1], shares[i] + kShareStep);
  }
  for (std::size_t i = 0; i < held_.size(); ++i) release(held_[i], shares[i]);
  held_.clear();
}

void ViewLimiter::finish() { release_all(); }

std::optional<FittedView> ViewLimiter::pop() {
  if (ready_.empty()) return std::nullopt;
  FittedView view = std::move(ready_.front());
  ready_.pop_front();
  return view;
}

}  // namespace gimbal
