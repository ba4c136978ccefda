#pragma once

#include <cstddef>
#include <deque>
#include <memory>

#include "pipeline/path/pose_filter.hpp"
#include "pipeline/path/window_size.hpp"

namespace gimbal {

/// w_n of (2.33) for a window that reaches `half_width` = (N - 1)/2 frames to either side: 1 in the
/// middle, 0 at both ends, so that N = 3 leaves poses as they are just as N = 1 does.
[[nodiscard]] double hann_weight(std::size_t distance, std::size_t half_width);

/// The thesis' low-pass: component-wise mean of sign-consistent quaternions under a Hann window
/// (2.33), normalised (2.34).
///
/// At both ends of a clip the window shrinks on both sides alike, down to a single frame: a
/// lopsided window would pull the view away from a camera that turns, most of all at the very ends.
/// Where the latency is shorter than half of the window, lopsided it must be: the past keeps its
/// length, for smoothness, the future is cut off at the latency, and the remaining weights are
/// normalised. The view then lags behind a camera that turns.
class HannFilter final : public PoseFilter {
 public:
  HannFilter(std::unique_ptr<WindowSize> window, PathLatency latency);

  void push(const FramePose& pose) override;
  void finish() override;
  [[nodiscard]] std::optional<FramePose> pop() override;

  /// Poses held at present: never more than the largest window and the latency, besides those that
  /// wait to be popped.
  [[nodiscard]] std::size_t held() const { return poses_.size(); }

 private:
  struct Reach {
    std::size_t half_width;  ///< of the Hann window, and how far it reaches back
    std::size_t ahead;       ///< how far it reaches forward
  };

  void release_next();
  [[nodiscard]] Reach reach_at(std::size_t index, std::size_t frames_ahead);
  [[nodiscard]] Eigen::Quaterniond mean_around(std::size_t index, const Reach& reach) const;
  [[nodiscard]] const FramePose& pose(std::size_t index) const;

  std::unique_ptr<WindowSize> window_;
  std::size_t latency_;
  std::deque<FramePose> poses_;  ///< signs consistent
  std::size_t first_held_ = 0;   ///< index of poses_.front()
  std::size_t pushed_ = 0;
  std::size_t released_ = 0;
  std::deque<FramePose> ready_;
};

}  // namespace gimbal
