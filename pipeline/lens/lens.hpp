#pragma once

#include <Eigen/Core>
#include <optional>
#include <variant>

#include "pipeline/lens/brown_model.hpp"
#include "pipeline/lens/fisheye_model.hpp"
#include "pipeline/lens/pinhole_model.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// A calibrated lens: between rays in camera axes (x right, y down, z forward) and pixels.
class Lens {
 public:
  /// Refuses K without positive focal lengths, with skew or with values that are not finite, and a
  /// number of distortion coefficients that the model does not have (none is always allowed).
  [[nodiscard]] static Result<Lens> create(LensParameters parameters);

  /// Pixel of a ray, any length; nothing where the model does not reach (behind the camera, beyond
  /// the radius where distortion folds back; a fisheye lens may see more than 90° off its axis).
  [[nodiscard]] std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& ray_camera) const;

  /// The same in units of the focal length, from the principal point.
  [[nodiscard]] std::optional<Eigen::Vector2d> image_point(const Eigen::Vector3d& ray_camera) const;

  /// How the pixel of a ray moves with the ray's x, y and z; nothing where the ray has none.
  [[nodiscard]] std::optional<Eigen::Matrix<double, 2, 3>> jacobian(
      const Eigen::Vector3d& ray_camera) const;

  /// Unit ray of a pixel, exact to 1e-9; nothing where no ray leads to it.
  [[nodiscard]] std::optional<Eigen::Vector3d> unproject(const Eigen::Vector2d& pixel) const;

  [[nodiscard]] const LensParameters& parameters() const { return parameters_; }

 private:
  using Model = std::variant<PinholeModel, BrownModel, FisheyeModel>;

  explicit Lens(LensParameters parameters);
  [[nodiscard]] static Model make_model(const LensParameters& parameters);

  LensParameters parameters_;
  Model model_;
};

}  // namespace gimbal
