#pragma once

#include <algorithm>

namespace gimbal {

/// From 0 at 0 to 1 at 1, with no kink at either end.
inline double smooth_step(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace gimbal
