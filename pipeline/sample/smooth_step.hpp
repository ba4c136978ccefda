#pragma once

#include <algorithm>
#include <concepts>

namespace gimbal {

/// From 0 at 0 to 1 at 1, with no kink at either end.
template <std::floating_point Real>
Real smooth_step(Real x) {
  const Real t = std::clamp(x, Real(0), Real(1));
  return t * t * (3 - 2 * t);
}

}  // namespace gimbal
