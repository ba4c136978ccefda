#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <vector>

#include "pipeline/lens/lens.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/virtual_camera.hpp"

namespace gimbal::test {

/// Where the picture shown at an output pixel was taken from, in source pixels.
using SourceMap = std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d& output_px)>;

/// q_world_camera while a line of the frame was exposed, as it truly was.
using TrueOrientation = std::function<Eigen::Quaterniond(double line)>;

/// A point of the output, as a direction in the virtual camera, and the direction in which what is
/// shown there truly lies.
struct ShownPoint {
  Eigen::Vector2d output_px;
  Eigen::Vector3d shown_ray;
  Eigen::Vector3d true_ray;
};

/// A grid of `columns` x `rows` points over the output, those without a source left out.
[[nodiscard]] std::vector<ShownPoint> compare_with_truth(const SourceMap& map, const Lens& lens,
                                                         ReadoutDirection direction,
                                                         const TrueOrientation& q_world_camera,
                                                         const VirtualCamera& camera,
                                                         ImageSize output_size, int columns,
                                                         int rows);

/// Distance, in output pixels, between where each point is shown and where a global shutter in the
/// virtual camera would have shown it.
[[nodiscard]] std::vector<double> errors_px(const std::vector<ShownPoint>& points,
                                            const PinholeIntrinsics& intrinsics);

/// The one rotation that brings the true rays closest to the shown ones (Kabsch): shown = q true. A
/// camera at q_world_camera q⁻¹ would have shown the picture without it.
[[nodiscard]] Eigen::Quaterniond common_rotation(const std::vector<ShownPoint>& points);

/// The same points with their common rotation taken out.
[[nodiscard]] std::vector<ShownPoint> without_common_rotation(std::vector<ShownPoint> points);

[[nodiscard]] double mean(const std::vector<double>& values);
[[nodiscard]] double maximum(const std::vector<double>& values);

}  // namespace gimbal::test
