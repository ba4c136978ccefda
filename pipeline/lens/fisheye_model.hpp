#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

namespace gimbal {

/// Fisheye: J. Kannala and S. S. Brandt, "A generic camera model and calibration method for
/// conventional, wide-angle, and fish-eye lenses", 2006, in OpenCV's form
/// radius = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸), θ the angle off the axis. Image points are in
/// units of the focal length, measured from the principal point. Unlike OpenCV's functions it also
/// reaches rays more than 90° off the axis.
class FisheyeModel {
 public:
  /// `coefficients`: k1 k2 k3 k4, or none for zeros.
  explicit FisheyeModel(const std::vector<double>& coefficients);

  /// Nothing for rays at `fold_angle` or beyond.
  [[nodiscard]] std::optional<Eigen::Vector2d> image_point(const Eigen::Vector3d& ray) const;

  /// How the image point moves with the ray, by its x, y and z; for rays that have one.
  [[nodiscard]] Eigen::Matrix<double, 2, 3> jacobian(const Eigen::Vector3d& ray) const;

  /// Unit ray; nothing where no ray inside `fold_angle` leads.
  [[nodiscard]] std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& image_point) const;

  /// Angle off the axis from which on the radius no longer grows; π if it always does. Radians.
  [[nodiscard]] double fold_angle() const { return fold_angle_; }

 private:
  [[nodiscard]] double radius(double angle) const;
  [[nodiscard]] double radius_slope(double angle) const;
  [[nodiscard]] double find_fold_angle() const;
  [[nodiscard]] double angle_of(double distance) const;

  std::array<double, 4> k_{};
  double fold_angle_;
};

}  // namespace gimbal
