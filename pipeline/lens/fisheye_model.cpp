#include "pipeline/lens/fisheye_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gimbal {

FisheyeModel::FisheyeModel(const std::vector<double>& coefficients) {
  std::copy_n(coefficients.begin(), std::min(coefficients.size(), k_.size()), k_.begin());
  fold_angle_ = find_fold_angle();
}

std::optional<Eigen::Vector2d> FisheyeModel::image_point(const Eigen::Vector3d& ray) const {
  const double off_axis = ray.head<2>().norm();
  const double angle = std::atan2(off_axis, ray.z());
  if (!(angle < fold_angle_) || ray.isZero(0)) return std::nullopt;
  if (off_axis == 0) return Eigen::Vector2d(0, 0);
  return Eigen::Vector2d(ray.head<2>() * (radius(angle) / off_axis));
}

Eigen::Matrix<double, 2, 3> FisheyeModel::jacobian(const Eigen::Vector3d& ray) const {
  const double off_axis = ray.head<2>().norm();
  Eigen::Matrix<double, 2, 3> J = Eigen::Matrix<double, 2, 3>::Zero();
  if (off_axis == 0) {
    J.leftCols<2>().diagonal().setConstant(radius_slope(0) / ray.z());
    return J;
  }
  const double angle = std::atan2(off_axis, ray.z());
  const double slope = radius_slope(angle) / ray.squaredNorm();
  const double along = slope * ray.z();            // of the radius by the distance off the axis
  const double across = radius(angle) / off_axis;  // around the axis
  const Eigen::Vector2d outwards = ray.head<2>() / off_axis;
  J.leftCols<2>() =
      across * Eigen::Matrix2d::Identity() + (along - across) * outwards * outwards.transpose();
  J.col(2) = -slope * off_axis * outwards;
  return J;
}

std::optional<Eigen::Vector3d> FisheyeModel::ray(const Eigen::Vector2d& image_point) const {
  const double distance = image_point.norm();
  if (distance == 0) return Eigen::Vector3d(0, 0, 1);
  if (!(distance < radius(fold_angle_))) return std::nullopt;
  const double angle = angle_of(distance);
  const Eigen::Vector2d across = image_point * (std::sin(angle) / distance);
  return Eigen::Vector3d(across.x(), across.y(), std::cos(angle));
}

double FisheyeModel::radius(double angle) const {
  const double a2 = angle * angle;
  return angle * (1 + a2 * (k_[0] + a2 * (k_[1] + a2 * (k_[2] + a2 * k_[3]))));
}

double FisheyeModel::radius_slope(double angle) const {
  const double a2 = angle * angle;
  return 1 + a2 * (3 * k_[0] + a2 * (5 * k_[1] + a2 * (7 * k_[2] + a2 * 9 * k_[3])));
}

double FisheyeModel::find_fold_angle() const {
  // Outwards in steps of a tenth of a degree until the radius no longer grows.
  constexpr int kSteps = 1800;
  double inside = 0;
  double outside = std::numbers::pi;
  for (int step = 1; step <= kSteps; ++step) {
    const double angle = std::numbers::pi * step / kSteps;
    if (!(radius_slope(angle) > 0)) {
      outside = angle;
      break;
    }
    inside = angle;
  }
  constexpr int kHalvings = 60;  // enough for all bits of a double
  for (int i = 0; i < kHalvings && inside < outside; ++i) {
    const double middle = 0.5 * (inside + outside);
    (radius_slope(middle) > 0 ? inside : outside) = middle;
  }
  return inside;
}

double FisheyeModel::angle_of(double distance) const {
  // Newton's method inside a bracket: the radius grows all the way up to the fold.
  double low = 0;
  double high = fold_angle_;
  double angle = std::min(distance, 0.5 * fold_angle_);
  constexpr int kMaximumIterations = 100;
  for (int i = 0; i < kMaximumIterations; ++i) {
    const double error = radius(angle) - distance;
    (error < 0 ? low : high) = angle;
    double next = angle - error / radius_slope(angle);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const bool settled = std::abs(next - angle) <= 1e-15 * (1 + angle);
    angle = next;
    if (settled) break;
  }
  return angle;
}

}  // namespace gimbal
