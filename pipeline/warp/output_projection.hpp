#pragma once

#include <Eigen/Core>
#include <optional>

#include "pipeline/lens/lens.hpp"
#include "pipeline/sample/virtual_camera.hpp"

namespace gimbal {

/// Where the rays that a virtual camera sees lie in its picture.
class OutputProjection {
 public:
  /// `lens` is the real camera's, and has to stay.
  OutputProjection(OutputLens output, const Lens& lens, const PinholeIntrinsics& intrinsics)
      : output_(output), lens_(&lens), intrinsics_(intrinsics) {}

  /// Nothing for rays that the picture cannot show: without a lens those nearly at a right angle to
  /// the axis or beyond, which would land tens of focal lengths away.
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector3d& unit_ray) const;

 private:
  OutputLens output_;
  const Lens* lens_;
  PinholeIntrinsics intrinsics_;
};

/// As wide as the real camera's picture where no field of view is given, else so many degrees from
/// its left edge to its right, about its middle.
[[nodiscard]] PinholeIntrinsics output_intrinsics(const LensParameters& lens, ImageSize size,
                                                  std::optional<double> horizontal_fov_deg);

}  // namespace gimbal
