#pragma once

#include <Eigen/Core>
#include <vector>

namespace gimbal {

inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Whether a closed polygon encloses a point, by the edges that a ray from there crosses.
inline bool contains(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& point) {
  if (polygon.empty()) return false;
  bool inside = false;
  Eigen::Vector2d previous = polygon.back() - point;
  for (const Eigen::Vector2d& corner : polygon) {
    const Eigen::Vector2d here = corner - point;
    const bool crosses = (here.y() > 0) != (previous.y() > 0);
    if (crosses && (cross(previous, here) > 0) == (here.y() > previous.y())) inside = !inside;
    previous = here;
  }
  return inside;
}

}  // namespace gimbal
