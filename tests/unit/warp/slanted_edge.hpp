#pragma once

#include <Eigen/Core>

#include "pipeline/sample/video_frame.hpp"

namespace gimbal::warp_scene {

/// A straight edge between dark and bright, blurred as by a lens: across it, levels follow the
/// integral of a Gaussian.
struct SlantedEdge {
  Eigen::Vector2d point_px;  ///< on the edge
  Eigen::Vector2d normal;    ///< towards the bright side, of length 1
  double blur_px;            ///< the Gaussian's standard deviation

  [[nodiscard]] double level(const Eigen::Vector2d& at) const;
};

/// The edge as pixels of 8 bits, in luma; chroma is grey.
[[nodiscard]] VideoFrame draw_edge(const SlantedEdge& edge, ImageSize size);

/// The spatial frequency, in cycles a pixel across the edge, at which the luma of a picture has
/// half of the contrast that it has at zero: ISO 12233's slanted-edge method. The edge's place and
/// direction in the picture are given, pixels within `reach_px` of it count.
[[nodiscard]] double mtf50(const VideoFrame& picture, const Eigen::Vector2d& point_px,
                           const Eigen::Vector2d& normal, double reach_px);

}  // namespace gimbal::warp_scene
