#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "pipeline/path/camera_path.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// From the views of one path to those of another that takes its place, without a jump: what they
/// differ by where they meet fades away.
class ViewFade {
 public:
  /// How the last frame was shown, and how the new path would have shown it.
  void begin(const SteadyView& shown, const SteadyView& instead);

  /// The new path's view of `frame`, still a little like the old path's; it gives way towards the
  /// real camera where the frame has no room for it.
  [[nodiscard]] SteadyView faded(const SteadyView& view, const PathFrame& frame) const;

 private:
  std::optional<SensorTime> since_;  ///< none: nothing fades
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  double zoom_ratio_ = 1;
};

}  // namespace gimbal
