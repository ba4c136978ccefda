#include "pipeline/path/view_fit.hpp"

namespace gimbal {
double needed_zoom(const RequiredZoom& required, const Eigen::Quaterniond& view) {
  return required(view) * kZoomMargin;
}

double fitting_share(const RequiredZoom& required, const Eigen::Quaterniond& real,
                     const Eigen::Quaterniond& view, double zoom) {
  if (needed_zoom(required, view) <= zoom) return 1;
  double fits = 0;
  double does_not = 1;
  constexpr int kHalvings = 10;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (fits + does_not) / 2;
    (needed_zoom(required, real.slerp(middle, view)) <= zoom ? fits : does_not) = middle;
  }
  return fits;
}

}  // namespace gimbal
