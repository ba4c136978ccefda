#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "pipeline/lens/lens.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/sample/view_room.hpp"
#include "pipeline/sample/virtual_camera.hpp"
#include "pipeline/warp/output_projection.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// The edge of a frame as a closed polygon of directions in the world, each from the camera as it
/// was when that point's line was exposed.
struct FrameOutline {
  std::vector<Eigen::Vector3f> rays_world;  ///< floats: many frames may wait with theirs
  /// Where the top, right, bottom and left side begin; each ends where the next one begins.
  std::array<std::size_t, 4> side_begin{};
};

/// `points_per_side` points along each side of the frame (at least 2), corners included once.
[[nodiscard]] FrameOutline trace_outline(const Lens& lens, ImageSize size,
                                         ReadoutDirection direction,
                                         const LineOrientation& q_world_camera,
                                         int points_per_side);

/// The outline as the camera's picture shows it, in its pixels; nothing if part of it is not seen.
[[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> pixels_of(
    const FrameOutline& outline, const Eigen::Quaterniond& q_world_camera,
    const OutputProjection& projection);

/// The smallest zoom, about the centre of the output, at which every output pixel of the camera
/// lies inside the outline; infinite if the centre itself sees past the edge. `unzoomed` is the
/// camera's projection at zoom 1, its principal point anywhere.
[[nodiscard]] double required_zoom(const FrameOutline& outline,
                                   const Eigen::Quaterniond& q_world_camera,
                                   const OutputProjection& unzoomed, ImageSize output_size);

/// How far a view may turn away from `q_world_camera`, with the frame's sides taken as straight:
/// each lies at its innermost point. Where the camera does not see all of the outline nothing can
/// be told, and any view is given room.
[[nodiscard]] ViewRoom view_room(const FrameOutline& outline,
                                 const Eigen::Quaterniond& q_world_camera,
                                 const OutputProjection& unzoomed, ImageSize output_size);

/// Magnifies about the centre of the picture.
[[nodiscard]] PinholeIntrinsics zoomed(const PinholeIntrinsics& intrinsics, ImageSize size,
                                       double zoom);

}  // namespace gimbal
