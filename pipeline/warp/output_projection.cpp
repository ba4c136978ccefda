#include "pipeline/warp/output_projection.hpp"

#include <cmath>
#include <numbers>

namespace gimbal {
namespace {

// The sine of about 3 degrees: beyond, triangles say nothing and coordinates lose their precision.
constexpr double kMinForward = 0.05;

}  // namespace

std::optional<Eigen::Vector2d> OutputProjection::pixel_of(const Eigen::Vector3d& unit_ray) const {
  std::optional<Eigen::Vector2d> point;
  if (output_ == OutputLens::kept) {
    point = lens_->image_point(unit_ray);
  } else if (unit_ray.z() >= kMinForward) {
    point = unit_ray.head<2>() / unit_ray.z();
  }
  if (!point) return std::nullopt;
  return Eigen::Vector2d(intrinsics_.fx * point->x() + intrinsics_.cx,
                         intrinsics_.fy * point->y() + intrinsics_.cy);
}

PinholeIntrinsics output_intrinsics(const LensParameters& lens, ImageSize size,
                                    std::optional<double> horizontal_fov_deg) {
  const Eigen::Matrix3d& K = lens.K;
  if (!horizontal_fov_deg) return {K(0, 0), K(1, 1), K(0, 2), K(1, 2)};
  const double half_rad = *horizontal_fov_deg * std::numbers::pi / 360;
  const double focal_px = size.width / 2.0 / std::tan(half_rad);
  return {focal_px, focal_px, (size.width - 1) / 2.0, (size.height - 1) / 2.0};
}

}  // namespace gimbal
