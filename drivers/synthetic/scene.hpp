#pragma once

#include <Eigen/Core>

namespace gimbal {

/// Red, green and blue in linear light, 0 to 1, and a fourth that means nothing: four make one
/// vector to the processor.
using Light = Eigen::Array4f;

/// What there is to see, infinitely far away: only turning the camera changes the view.
class Scene {
 public:
  Scene() = default;
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  virtual ~Scene() = default;

  /// Red, green and blue in linear light, 0 to 1, seen in a direction (unit vector in world axes,
  /// z up). Called from several threads at once.
  [[nodiscard]] virtual Eigen::Vector3d color(const Eigen::Vector3d& direction_world) const = 0;
};

}  // namespace gimbal
