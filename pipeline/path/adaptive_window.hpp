#pragma once

#include <cstddef>
#include <deque>

#include "pipeline/path/pan_detector.hpp"
#include "pipeline/path/window_size.hpp"

namespace gimbal {

/// The thesis' adaptive window (2.3.3): wide while the camera is held, narrow in a pan. It slides
/// by one frame on either side for each frame, so that near a pan its edge reaches no further into
/// the pan than the narrow window does. Where the future is known the window is narrow when the pan
/// begins; with less latency it only starts to slide once the pan has been detected.
class AdaptiveWindow final : public WindowSize {
 public:
  explicit AdaptiveWindow(const AdaptiveHannParameters& parameters);

  void push(const FramePose& pose) override;
  [[nodiscard]] std::size_t half_width(std::size_t index) override;
  [[nodiscard]] std::size_t largest_half_width() const override { return wide_; }

 private:
  struct Pan {
    std::size_t first_frame;
    std::size_t last_frame;
  };

  void mark_pan(const Pan& pan);
  void forget_pans_before(std::size_t index);
  [[nodiscard]] std::size_t frames_to_nearest_pan(std::size_t index) const;

  PanDetector detector_;
  std::size_t wide_;
  std::size_t narrow_;
  std::size_t frames_seen_ = 0;
  std::size_t half_width_;
  std::deque<Pan> pans_;
};

}  // namespace gimbal
