#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "tests/judge/frame_tracks.hpp"

namespace gimbal::judge {

/// A pinhole with square pixels whose principal point is the picture's middle: all that can be
/// assumed of a stranger's video.
struct Pinhole {
  double focal_px = 0;
  cv::Size size;
};

/// Camera axes: x right, y down, z forward. Not of unit length: z is 1.
[[nodiscard]] cv::Vec3d ray_of(const Pinhole& camera, const cv::Point2f& px);

/// Where the second picture shows what the first shows at `px`. R_to_from takes the first camera's
/// axes to the second's.
[[nodiscard]] cv::Point2f turned(const Pinhole& camera, const cv::Matx33d& R_to_from,
                                 const cv::Point2f& px);

/// The rotation of a camera between two pictures that explains most tracks best (R_to_from): the
/// best of many drawn from two tracks each (RANSAC; the same tracks, the same draws), then least
/// squares over those near it, with less weight for the farther (Tukey). Nothing if fewer than 12
/// tracks agree.
[[nodiscard]] std::optional<cv::Matx33d> fit_rotation(const Pinhole& camera,
                                                      const std::vector<Track>& tracks);

}  // namespace gimbal::judge
