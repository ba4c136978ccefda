#include "tests/support/truth_error.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace gimbal::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d ray_of(const Vector2d& pixel, const PinholeIntrinsics& k) {
  return Vector3d((pixel.x() - k.cx) / k.fx, (pixel.y() - k.cy) / k.fy, 1).normalized();
}

/// Infinitely far for what lies behind the camera: an error that no test lets pass.
Vector2d pixel_of(const Vector3d& ray, const PinholeIntrinsics& k) {
  if (ray.z() <= 0) return Vector2d::Constant(std::numeric_limits<double>::infinity());
  return {k.fx * ray.x() / ray.z() + k.cx, k.fy * ray.y() / ray.z() + k.cy};
}

double line_of(const Vector2d& source_px, ReadoutDirection direction) {
  return reads_rows(direction) ? source_px.y() : source_px.x();
}

}  // namespace

std::vector<ShownPoint> compare_with_truth(const SourceMap& map, const Lens& lens,
                                           ReadoutDirection direction,
                                           const TrueOrientation& q_world_camera,
                                           const VirtualCamera& camera, ImageSize output_size,
                                           int columns, int rows) {
  std::vector<ShownPoint> points;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Vector2d output_px((output_size.width - 1.0) * (column + 0.5) / columns,
                               (output_size.height - 1.0) * (row + 0.5) / rows);
      const auto source_px = map(output_px);
      if (!source_px) continue;
      const auto ray_source = lens.unproject(*source_px);
      if (!ray_source) continue;
      const Vector3d ray_world = q_world_camera(line_of(*source_px, direction)) * *ray_source;
      points.push_back({output_px, ray_of(output_px, camera.intrinsics),
                        camera.q_world_camera.conjugate() * ray_world});
    }
  }
  return points;
}

std::vector<double> errors_px(const std::vector<ShownPoint>& points,
                              const PinholeIntrinsics& intrinsics) {
  std::vector<double> errors;
  errors.reserve(points.size());
  for (const ShownPoint& point : points) {
    errors.push_back(
        (pixel_of(point.shown_ray, intrinsics) - pixel_of(point.true_ray, intrinsics)).norm());
  }
  return errors;
}

Eigen::Quaterniond common_rotation(const std::vector<ShownPoint>& points) {
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (const ShownPoint& point : points) {
    correlation += point.shown_ray * point.true_ray.transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) *= -1;
  return Eigen::Quaterniond(Eigen::Matrix3d(U * svd.matrixV().transpose()));
}

std::vector<ShownPoint> without_common_rotation(std::vector<ShownPoint> points) {
  const Eigen::Quaterniond q_shown_true = common_rotation(points);
  for (ShownPoint& point : points) point.true_ray = q_shown_true * point.true_ray;
  return points;
}

double mean(const std::vector<double>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double maximum(const std::vector<double>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  return *std::max_element(values.begin(), values.end());
}

}  // namespace gimbal::test
