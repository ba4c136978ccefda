#include "pipeline/path/camera_path.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/path/adaptive_window.hpp"
#include "pipeline/path/bounded_path.hpp"
#include "pipeline/path/hann_filter.hpp"
#include "pipeline/path/limited_path.hpp"

namespace gimbal {
namespace {

class ConstantWindow final : public WindowSize {
 public:
  explicit ConstantWindow(int window) : half_width_(half_of_window(window)) {}

  void push(const FramePose&) override {}
  [[nodiscard]] std::size_t half_width(std::size_t) override { return half_width_; }
  [[nodiscard]] std::size_t largest_half_width() const override { return half_width_; }

 private:
  std::size_t half_width_;
};

/// Odd window that lasts as long at `fps` as `amount` of `window` does at the thesis' frame rate.
int scaled_window(int window, double amount, double fps) {
  const double frames = (window - 1) * std::clamp(amount, 0.0, 1.0) * fps / kThesisFps;
  return 1 + 2 * static_cast<int>(std::lround(0.5 * frames));
}

}  // namespace

int window_for_amount(double amount, double fps) {
  return scaled_window(AdaptiveHannParameters{}.wide_window, amount, fps);
}

AdaptiveHannParameters adaptive_hann_for_amount(double amount, double fps) {
  AdaptiveHannParameters parameters;
  parameters.wide_window = scaled_window(parameters.wide_window, amount, fps);
  parameters.narrow_window = scaled_window(parameters.narrow_window, amount, fps);
  return parameters;
}

std::unique_ptr<PoseFilter> make_hann_filter(int window, PathLatency latency) {
  return std::make_unique<HannFilter>(std::make_unique<ConstantWindow>(window), latency);
}

std::unique_ptr<PoseFilter> make_adaptive_hann_filter(const AdaptiveHannParameters& parameters,
                                                      PathLatency latency) {
  return std::make_unique<HannFilter>(std::make_unique<AdaptiveWindow>(parameters), latency);
}

std::unique_ptr<CameraPath> make_hann_path(int window, ZoomChoice zoom, PathLatency latency) {
  return std::make_unique<LimitedPath>(make_hann_filter(window, latency), zoom, latency);
}

std::unique_ptr<CameraPath> make_adaptive_hann_path(const AdaptiveHannParameters& parameters,
                                                    ZoomChoice zoom, PathLatency latency) {
  return std::make_unique<LimitedPath>(make_adaptive_hann_filter(parameters, latency), zoom,
                                       latency);
}

std::unique_ptr<CameraPath> make_bounded_path(const BoundedPathParameters& parameters,
                                              ZoomChoice zoom, PathLatency latency) {
  return std::make_unique<BoundedPath>(parameters, zoom, latency);
}

}  // namespace gimbal
