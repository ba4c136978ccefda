#pragma once

#include <cstddef>

#include "pipeline/path/camera_path.hpp"

namespace gimbal {

/// How many frames a path's window reaches to either side of each frame.
class WindowSize {
 public:
  WindowSize() = default;
  WindowSize(const WindowSize&) = delete;
  WindowSize& operator=(const WindowSize&) = delete;
  virtual ~WindowSize() = default;

  /// Sees every pose before the path asks for a width that may depend on it.
  virtual void push(const FramePose& pose) = 0;

  /// Frames to either side of frame `index`, by what was pushed so far. Asked once for every frame,
  /// in order.
  [[nodiscard]] virtual std::size_t half_width(std::size_t index) = 0;

  /// No half width is larger, nor does any depend on poses further ahead.
  [[nodiscard]] virtual std::size_t largest_half_width() const = 0;
};

/// Half width of a window of N frames, (N - 1)/2.
constexpr std::size_t half_of_window(int window) {
  return window > 1 ? static_cast<std::size_t>(window / 2) : 0;
}

}  // namespace gimbal
