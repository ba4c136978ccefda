#include "pipeline/lens/brown_model.hpp"

#include <Eigen/LU>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace gimbal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double value_or_zero(const std::vector<double>& values, std::size_t index) {
  return index < values.size() ? values[index] : 0.0;
}

}  // namespace

BrownModel::BrownModel(const std::vector<double>& coefficients)
    : k1_(value_or_zero(coefficients, 0)),
      k2_(value_or_zero(coefficients, 1)),
      k3_(value_or_zero(coefficients, 4)),
      k4_(value_or_zero(coefficients, 5)),
      k5_(value_or_zero(coefficients, 6)),
      k6_(value_or_zero(coefficients, 7)),
      p1_(value_or_zero(coefficients, 2)),
      p2_(value_or_zero(coefficients, 3)),
      fold_radius_(find_fold_radius()) {}

std::optional<Eigen::Vector2d> BrownModel::image_point(const Eigen::Vector3d& ray) const {
  const auto undistorted = pinhole_.image_point(ray);
  if (!undistorted || !(undistorted->norm() < fold_radius_)) return std::nullopt;
  return distort(*undistorted);
}

Eigen::Matrix<double, 2, 3> BrownModel::jacobian(const Eigen::Vector3d& ray) const {
  return distortion_jacobian(ray.head<2>() / ray.z()) * pinhole_.jacobian(ray);
}

std::optional<Eigen::Vector3d> BrownModel::ray(const Eigen::Vector2d& image_point) const {
  const auto undistorted = undistort(image_point);
  if (!undistorted) return std::nullopt;
  return pinhole_.ray(*undistorted);
}

BrownModel::Radial BrownModel::radial(double r2) const {
  const double above = 1 + r2 * (k1_ + r2 * (k2_ + r2 * k3_));
  const double below = 1 + r2 * (k4_ + r2 * (k5_ + r2 * k6_));
  const double above_slope = k1_ + r2 * (2 * k2_ + r2 * 3 * k3_);
  const double below_slope = k4_ + r2 * (2 * k5_ + r2 * 3 * k6_);
  const double factor = above / below;
  return {factor, (above_slope - factor * below_slope) / below};
}

Eigen::Vector2d BrownModel::distort(const Eigen::Vector2d& point) const {
  const double x = point.x();
  const double y = point.y();
  const double r2 = point.squaredNorm();
  const double factor = radial(r2).factor;
  return {x * factor + 2 * p1_ * x * y + p2_ * (r2 + 2 * x * x),
          y * factor + p1_ * (r2 + 2 * y * y) + 2 * p2_ * x * y};
}

Eigen::Matrix2d BrownModel::distortion_jacobian(const Eigen::Vector2d& point) const {
  const double x = point.x();
  const double y = point.y();
  const auto [factor, slope] = radial(point.squaredNorm());
  Eigen::Matrix2d J;
  J(0, 0) = factor + 2 * x * x * slope + 2 * p1_ * y + 6 * p2_ * x;
  J(0, 1) = 2 * x * y * slope + 2 * p1_ * x + 2 * p2_ * y;
  J(1, 0) = J(0, 1);
  J(1, 1) = factor + 2 * y * y * slope + 6 * p1_ * y + 2 * p2_ * x;
  return J;
}

bool BrownModel::folds_at(double radius) const {
  // Along a circle the determinant is a trigonometric polynomial of low order: 64 points see it.
  constexpr int kDirections = 64;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2 * std::numbers::pi * i / kDirections;
    const Eigen::Vector2d point(radius * std::cos(angle), radius * std::sin(angle));
    if (!(distortion_jacobian(point).determinant() > 0)) return true;
  }
  return false;
}

double BrownModel::find_fold_radius() const {
  // Outwards in steps of a tenth of a degree of the field of view, until the first fold or pole.
  constexpr int kSteps = 900;
  double inside = 0;
  double outside = kInfinity;
  for (int step = 1; step < kSteps && outside == kInfinity; ++step) {
    const double radius = std::tan(std::numbers::pi / 2 * step / kSteps);
    (folds_at(radius) ? outside : inside) = radius;
  }
  if (outside == kInfinity) return kInfinity;
  constexpr int kHalvings = 60;  // enough for all bits of a double
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (inside + outside);
    (folds_at(middle) ? outside : inside) = middle;
  }
  return inside;
}

double BrownModel::undistorted_radius(double distorted_radius) const {
  double low = 0;
  double high = std::isfinite(fold_radius_) ? fold_radius_ : 2 * distorted_radius;
  constexpr int kMaximumDoublings = 64;
  for (int i = 0; i < kMaximumDoublings && !std::isfinite(fold_radius_) &&
                  high * radial(high * high).factor < distorted_radius;
       ++i) {
    high *= 2;
  }
  constexpr int kHalvings = 20;  // a start for Newton's method, no more
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (middle * radial(middle * middle).factor < distorted_radius ? low : high) = middle;
  }
  return low;
}

std::optional<Eigen::Vector2d> BrownModel::undistort(const Eigen::Vector2d& distorted) const {
  const double distorted_radius = distorted.norm();
  if (distorted_radius == 0) return Eigen::Vector2d(0, 0);
  Eigen::Vector2d point = distorted * (undistorted_radius(distorted_radius) / distorted_radius);
  Eigen::Vector2d residual = distort(point) - distorted;
  const double tolerance = 1e-13 * (1 + distorted_radius);
  constexpr int kMaximumIterations = 50;
  for (int i = 0; i < kMaximumIterations && residual.norm() > tolerance; ++i) {
    Eigen::Vector2d step = -distortion_jacobian(point).inverse() * residual;
    // A step that makes things worse, or leaves the circle where the map is one to one, is halved.
    constexpr int kMaximumHalvings = 40;
    for (int j = 0; j < kMaximumHalvings; ++j) {
      const Eigen::Vector2d candidate = point + step;
      if (candidate.norm() < fold_radius_ &&
          (distort(candidate) - distorted).norm() < residual.norm()) {
        break;
      }
      step *= 0.5;
    }
    point += step;
    residual = distort(point) - distorted;
  }
  constexpr double kAccepted = 1e-11;  // rounding of a point far off the axis stays below
  if (!(residual.norm() <= kAccepted * (1 + distorted_radius))) return std::nullopt;
  if (!(point.norm() < fold_radius_)) return std::nullopt;
  return point;
}

}  // namespace gimbal
