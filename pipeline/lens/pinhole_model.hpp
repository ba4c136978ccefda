#pragma once

#include <Eigen/Core>
#include <optional>

namespace gimbal {

/// Central projection without distortion. Image points are in units of the focal length, measured
/// from the principal point (x right, y down).
class PinholeModel {
 public:
  /// Nothing for rays that do not point forward.
  [[nodiscard]] std::optional<Eigen::Vector2d> image_point(const Eigen::Vector3d& ray) const {
    if (!(ray.z() > 0)) return std::nullopt;
    return Eigen::Vector2d(ray.head<2>() / ray.z());
  }

  /// How the image point moves with the ray, by its x, y and z; for rays that have one.
  [[nodiscard]] Eigen::Matrix<double, 2, 3> jacobian(const Eigen::Vector3d& ray) const {
    Eigen::Matrix<double, 2, 3> J;
    J << 1, 0, -ray.x() / ray.z(),  //
        0, 1, -ray.y() / ray.z();
    return J / ray.z();
  }

  /// Unit ray.
  [[nodiscard]] std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& image_point) const {
    return Eigen::Vector3d(image_point.x(), image_point.y(), 1).normalized();
  }
};

}  // namespace gimbal
