#pragma once

#include <memory>
#include <optional>

#include "pipeline/path/camera_path.hpp"

namespace gimbal {

/// Smooths poses without regard to what their frames can show. Latency as for CameraPath.
class PoseFilter {
 public:
  PoseFilter() = default;
  PoseFilter(const PoseFilter&) = delete;
  PoseFilter& operator=(const PoseFilter&) = delete;
  virtual ~PoseFilter() = default;

  virtual void push(const FramePose& pose) = 0;

  /// No more poses come: what is held is released by `pop`.
  virtual void finish() = 0;

  /// The next smoothed pose, in order, once enough of the future is known.
  [[nodiscard]] virtual std::optional<FramePose> pop() = 0;
};

/// Hann window of `window` frames.
[[nodiscard]] std::unique_ptr<PoseFilter> make_hann_filter(int window, PathLatency latency);

/// Hann windows between the narrow and the wide one.
[[nodiscard]] std::unique_ptr<PoseFilter> make_adaptive_hann_filter(
    const AdaptiveHannParameters& parameters, PathLatency latency);

}  // namespace gimbal
