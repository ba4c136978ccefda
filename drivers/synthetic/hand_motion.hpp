#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "drivers/synthetic/motion.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// Random oscillation in a band of frequencies, about or along each axis.
struct OscillationBand {
  double low_hz = 0;
  double high_hz = 0;
  Eigen::Vector3d rms = Eigen::Vector3d::Zero();
};

/// Looks aside and back, again and again: rest, a turn with a smooth rate, rest, the turn back.
struct Pan {
  double angle_rad = 0;
  SensorDuration turn{};  ///< the rate is a raised cosine, at most 2 angle / turn
  SensorDuration rest{};
};

/// How someone or something carries a camera.
struct HandModel {
  std::vector<OscillationBand> rotation_rad;   ///< pitch, yaw and roll: about camera x, y and z
  std::vector<OscillationBand> translation_m;  ///< of the pivot, along world x, y and z
  Pan pan;
  /// From what the hand turns about (elbow, shoulder) to the camera, in camera axes.
  Eigen::Vector3d lever_camera_m = Eigen::Vector3d::Zero();
  double pitch_rad = 0;  ///< how far up the camera looks on average
};

/// Physiological tremor lies at 6 to 12 Hz (Stiles and Randall, J. Appl. Physiol. 1967), steps near
/// 2 Hz walking and 2.8 Hz running, with sway at half of it.
[[nodiscard]] HandModel walking_hand();
[[nodiscard]] HandModel running_hand();
[[nodiscard]] HandModel panning_hand();
[[nodiscard]] HandModel vehicle_mount();
[[nodiscard]] HandModel tripod();  ///< nothing moves

/// From a little before time zero to a little after `duration`. The same model and seed make the
/// same motion.
[[nodiscard]] Motion make_hand_motion(const HandModel& model, SensorDuration duration,
                                      std::uint64_t seed);

}  // namespace gimbal
