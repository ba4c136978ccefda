#include "pipeline/lens/lens.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

namespace gimbal {
namespace {

struct ModelTraits {
  std::string_view name;
  std::string_view coefficients;
  std::vector<std::size_t> counts;
};

ModelTraits traits_of(LensModel model) {
  switch (model) {
    case LensModel::pinhole:
      return {"pinhole", "none", {0}};
    case LensModel::brown:
      return {"brown", "k1 k2 p1 p2 [k3 [k4 k5 k6]]", {0, 4, 5, 8}};
    case LensModel::fisheye:
      return {"fisheye", "k1 k2 k3 k4", {0, 4}};
  }
  return {"unknown", "none", {}};
}

Result<void> check_K(const Eigen::Matrix3d& K) {
  if (!K.allFinite()) {
    return bad_input("camera matrix K: a value is not a finite number; calibrate the camera again");
  }
  if (K(0, 0) <= 0 || K(1, 1) <= 0) {
    return bad_input(fmt::format(
        "camera matrix K: focal lengths fx = {:g}, fy = {:g} must be positive; write K as "
        "[[fx, 0, cx], [0, fy, cy], [0, 0, 1]] in pixels",
        K(0, 0), K(1, 1)));
  }
  if (K(0, 1) != 0) {
    return bad_input(fmt::format(
        "camera matrix K: skew {:g} in the first row is not supported; calibrate without skew",
        K(0, 1)));
  }
  if (K(1, 0) != 0 || K.row(2) != Eigen::RowVector3d(0, 0, 1)) {
    return bad_input(
        "camera matrix K: the rows must read [fx, 0, cx], [0, fy, cy], [0, 0, 1]; "
        "correct their order");
  }
  return {};
}

Result<void> check_distortion(const LensParameters& parameters) {
  const ModelTraits traits = traits_of(parameters.model);
  const auto& distortion = parameters.distortion;
  if (std::ranges::find(traits.counts, distortion.size()) == traits.counts.end()) {
    return bad_input(
        fmt::format("lens distortion: {} coefficients do not fit the model \"{}\", which takes {}; "
                    "correct the list or the model",
                    distortion.size(), traits.name, traits.coefficients));
  }
  if (!std::ranges::all_of(distortion, [](double k) { return std::isfinite(k); })) {
    return bad_input(
        "lens distortion: a coefficient is not a finite number; calibrate the camera again");
  }
  return {};
}

}  // namespace

Result<Lens> Lens::create(LensParameters parameters) {
  if (auto checked = check_K(parameters.K); !checked) return tl::unexpected(checked.error());
  if (auto checked = check_distortion(parameters); !checked) {
    return tl::unexpected(checked.error());
  }
  return Lens(std::move(parameters));
}

Lens::Lens(LensParameters parameters)
    : parameters_(std::move(parameters)), model_(make_model(parameters_)) {}

Lens::Model Lens::make_model(const LensParameters& parameters) {
  switch (parameters.model) {
    case LensModel::brown:
      return BrownModel(parameters.distortion);
    case LensModel::fisheye:
      return FisheyeModel(parameters.distortion);
    case LensModel::pinhole:
      break;
  }
  return PinholeModel();
}

std::optional<Eigen::Vector2d> Lens::image_point(const Eigen::Vector3d& ray_camera) const {
  if (!ray_camera.allFinite()) return std::nullopt;
  return std::visit([&](const auto& model) { return model.image_point(ray_camera); }, model_);
}

std::optional<Eigen::Vector2d> Lens::project(const Eigen::Vector3d& ray_camera) const {
  const auto point = image_point(ray_camera);
  if (!point) return std::nullopt;
  const Eigen::Matrix3d& K = parameters_.K;
  return Eigen::Vector2d(K(0, 0) * point->x() + K(0, 2), K(1, 1) * point->y() + K(1, 2));
}

std::optional<Eigen::Matrix<double, 2, 3>> Lens::jacobian(const Eigen::Vector3d& ray_camera) const {
  if (!image_point(ray_camera)) return std::nullopt;
  const Eigen::Vector2d focal_px = parameters_.K.diagonal().head<2>();
  return std::visit(
      [&](const auto& model) -> Eigen::Matrix<double, 2, 3> {
        return focal_px.asDiagonal() * model.jacobian(ray_camera);
      },
      model_);
}

std::optional<Eigen::Vector3d> Lens::unproject(const Eigen::Vector2d& pixel) const {
  if (!pixel.allFinite()) return std::nullopt;
  const Eigen::Matrix3d& K = parameters_.K;
  const Eigen::Vector2d point((pixel.x() - K(0, 2)) / K(0, 0), (pixel.y() - K(1, 2)) / K(1, 1));
  return std::visit([&](const auto& model) { return model.ray(point); }, model_);
}

}  // namespace gimbal
