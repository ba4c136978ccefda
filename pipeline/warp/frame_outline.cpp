#include "pipeline/warp/frame_outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace gimbal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Vector2d center_of(ImageSize size) {
  return {(size.width - 1) / 2.0, (size.height - 1) / 2.0};
}

/// Points of the outline as the camera sees them, in half output sizes from the output's centre:
/// the output at zoom z is the square |x|, |y| <= 1/z. Nothing if part of the outline is behind it.
std::optional<std::vector<Vector2d>> seen_from(const FrameOutline& outline,
                                               const Eigen::Quaterniond& q_world_camera,
                                               const OutputProjection& projection,
                                               ImageSize output_size) {
  const Vector2d center = center_of(output_size);
  const Eigen::Matrix3d R_camera_world = q_world_camera.conjugate().toRotationMatrix();
  std::vector<Vector2d> points;
  points.reserve(outline.rays_world.size());
  for (const Eigen::Vector3f& ray_world : outline.rays_world) {
    const Vector3d ray = R_camera_world * ray_world.cast<double>();
    const auto pixel = projection.pixel_of(ray);
    if (!pixel) return std::nullopt;
    points.emplace_back((*pixel - center).cwiseQuotient(center));
  }
  return points;
}

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool contains_origin(const std::vector<Vector2d>& polygon) {
  bool inside = false;
  Vector2d previous = polygon.back();
  for (const Vector2d& point : polygon) {
    const bool crosses = (point.y() > 0) != (previous.y() > 0);
    if (crosses && (cross(previous, point) > 0) == (point.y() > previous.y())) inside = !inside;
    previous = point;
  }
  return inside;
}

/// Least of max(|x|, |y|) on the segment: it is convex there, so it lies at an end or where one of
/// its linear pieces meets another.
double square_distance(const Vector2d& a, const Vector2d& b) {
  const Vector2d d = b - a;
  double least = std::min(a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff());
  const auto try_at = [&](double numerator, double denominator) {
    if (denominator == 0) return;
    const double t = numerator / denominator;
    if (t > 0 && t < 1) least = std::min(least, (a + t * d).cwiseAbs().maxCoeff());
  };
  try_at(a.y() - a.x(), d.x() - d.y());
  try_at(-a.y() - a.x(), d.x() + d.y());
  try_at(-a.x(), d.x());
  try_at(-a.y(), d.y());
  return least;
}

}  // namespace

FrameOutline trace_outline(const Lens& lens, ImageSize size, ReadoutDirection direction,
                           const LineOrientation& q_world_camera, int points_per_side) {
  const std::array<Vector2d, 4> corners = {Vector2d(-0.5, -0.5), Vector2d(size.width - 0.5, -0.5),
                                           Vector2d(size.width - 0.5, size.height - 0.5),
                                           Vector2d(-0.5, size.height - 0.5)};
  FrameOutline outline;
  for (std::size_t side = 0; side < corners.size(); ++side) {
    const Vector2d& from = corners[side];
    const Vector2d& to = corners[(side + 1) % corners.size()];
    for (int i = 0; i + 1 < points_per_side; ++i) {
      const Vector2d pixel = from + (to - from) * i / (points_per_side - 1);
      const double line = reads_rows(direction) ? pixel.y() : pixel.x();
      if (const auto ray = lens.unproject(pixel)) {
        outline.rays_world.emplace_back((q_world_camera(line) * *ray).cast<float>());
      }
    }
  }
  return outline;
}

double required_zoom(const FrameOutline& outline, const Eigen::Quaterniond& q_world_camera,
                     const OutputProjection& unzoomed, ImageSize output_size) {
  const auto polygon = seen_from(outline, q_world_camera, unzoomed, output_size);
  if (!polygon || polygon->size() < 3 || !contains_origin(*polygon)) return kInfinity;
  double least = kInfinity;
  Vector2d previous = polygon->back();
  for (const Vector2d& point : *polygon) {
    least = std::min(least, square_distance(previous, point));
    previous = point;
  }
  return 1 / least;
}

PinholeIntrinsics zoomed(const PinholeIntrinsics& intrinsics, ImageSize size, double zoom) {
  const Vector2d center = center_of(size);
  return {intrinsics.fx * zoom, intrinsics.fy * zoom,
          center.x() + (intrinsics.cx - center.x()) * zoom,
          center.y() + (intrinsics.cy - center.y()) * zoom};
}

}  // namespace gimbal
