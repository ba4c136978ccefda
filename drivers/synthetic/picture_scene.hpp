#pragma once

#include <Eigen/Core>

#include "drivers/synthetic/scene.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// A picture laid on a sphere around the camera: its middle lies along the world's x on the
/// horizon, columns are headings and rows are elevations. Past its edges it is mirrored, so that
/// there is something to see everywhere.
class PictureScene : public Scene {
 public:
  /// `width_rad`: the angle that the picture's width spans. Precondition: at least one pixel.
  PictureScene(VideoFrame picture, double width_rad);

  [[nodiscard]] Eigen::Vector3d color(const Eigen::Vector3d& direction_world) const override;

 private:
  [[nodiscard]] Eigen::Vector3d pixel(int x, int y) const;

  VideoFrame picture_;
  double pixels_per_radian_;
};

}  // namespace gimbal
