#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "pipeline/lens/pinhole_model.hpp"

namespace gimbal {

/// Central projection followed by radial and tangential distortion: D. C. Brown, "Close-range
/// camera calibration", 1971, with the rational radial part of OpenCV (calib3d). Image points are
/// in units of the focal length, measured from the principal point.
class BrownModel {
 public:
  /// `coefficients`: k1 k2 p1 p2 [k3 [k4 k5 k6]], OpenCV's order; those that are missing are zero.
  explicit BrownModel(const std::vector<double>& coefficients);

  /// Nothing for rays that do not point forward or that lie at `fold_radius` or beyond.
  [[nodiscard]] std::optional<Eigen::Vector2d> image_point(const Eigen::Vector3d& ray) const;

  /// How the image point moves with the ray, by its x, y and z; for rays that have one.
  [[nodiscard]] Eigen::Matrix<double, 2, 3> jacobian(const Eigen::Vector3d& ray) const;

  /// Unit ray; nothing where no ray inside `fold_radius` leads.
  [[nodiscard]] std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& image_point) const;

  /// Radius of the largest circle round the axis, in the undistorted image, inside which distortion
  /// is one to one; infinity if it is so everywhere.
  [[nodiscard]] double fold_radius() const { return fold_radius_; }

 private:
  /// The radial factor and its derivative by r².
  struct Radial {
    double factor;
    double slope;
  };

  [[nodiscard]] Radial radial(double r2) const;
  [[nodiscard]] Eigen::Vector2d distort(const Eigen::Vector2d& point) const;
  /// How a distorted point moves with the undistorted one.
  [[nodiscard]] Eigen::Matrix2d distortion_jacobian(const Eigen::Vector2d& point) const;
  [[nodiscard]] bool folds_at(double radius) const;
  [[nodiscard]] double find_fold_radius() const;
  [[nodiscard]] double undistorted_radius(double distorted_radius) const;
  [[nodiscard]] std::optional<Eigen::Vector2d> undistort(const Eigen::Vector2d& distorted) const;

  double k1_, k2_, k3_, k4_, k5_, k6_;
  double p1_, p2_;
  double fold_radius_;
  PinholeModel pinhole_;
};

}  // namespace gimbal
