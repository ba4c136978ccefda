#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <optional>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// What counts as a pan. In physical units, so that the frame rate does not matter.
struct PanDetectorParameters {
  /// Rate about one axis that still passes for holding the camera; the drift of the CUSUM test.
  double held_rate_rad_s = 0.35;
  /// Turn in excess of the held rate that makes a pan; the threshold of the CUSUM test.
  double excess_angle_rad = 0.1;
};

/// Detects deliberate fast rotation, as opposed to shake, with a two-sided CUSUM test for each axis
/// (E. S. Page, "Continuous inspection schemes", 1954; thesis 2.3.3) on the change of orientation
/// from frame to frame. A side sums the turn beyond the held rate, never below zero. A pan is on
/// once a sum reaches the threshold, where it is cut off, until it is back at zero. Shake turns
/// back before it adds up.
class PanDetector {
 public:
  explicit PanDetector(const PanDetectorParameters& parameters);

  /// Takes the next frame's pose. While a pan is on: how many frames ago it began, that is, when
  /// the sum that gave it away left zero.
  std::optional<std::size_t> update(SensorTime time, const Eigen::Quaterniond& q_world_camera);

 private:
  struct Pose {
    SensorTime time;
    Eigen::Quaterniond q_world_camera;
  };

  class OneSidedTest {
   public:
    void add(double excess_rad, double threshold_rad);
    [[nodiscard]] std::optional<std::size_t> frames_since_change() const;

   private:
    double sum_rad_ = 0;
    std::size_t frames_above_zero_ = 0;
    bool alarm_ = false;
  };

  PanDetectorParameters parameters_;
  std::optional<Pose> last_;
  std::array<OneSidedTest, 6> tests_;  ///< both directions about x, y and z of the camera
};

}  // namespace gimbal
