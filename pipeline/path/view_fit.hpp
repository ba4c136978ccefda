#pragma once

#include <Eigen/Geometry>

#include "pipeline/path/camera_path.hpp"

namespace gimbal {

/// A mesh is affine between its vertices, the outline is its edge: this much more zoom covers what
/// rounding could uncover.
constexpr double kZoomMargin = 1.0005;

/// The zoom that a view needs, margin included.
[[nodiscard]] double needed_zoom(const RequiredZoom& required, const Eigen::Quaterniond& view);

/// How much of the way from the real camera to `view` fits at `zoom`: 1 if all of it does, 0 if
/// nothing does but perhaps the real camera itself.
[[nodiscard]] double fitting_share(const RequiredZoom& required, const Eigen::Quaterniond& real,
                                   const Eigen::Quaterniond& view, double zoom);

}  // namespace gimbal
