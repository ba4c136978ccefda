#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {

/// CoreMotion's accelerometer is in g and has the sign of gravity: face up reads (0, 0, -1).
inline constexpr double kCoreMotionToSpecificForce_m_s2 = -kStandardGravity_m_s2;

/// The rear camera of a phone in landscape, home button on the right. A phone's axes (Apple's and
/// Android's): x right and y up along the portrait screen, z out of it.
[[nodiscard]] Eigen::Matrix3d R_landscape_camera_phone();

/// The folder's video (.mkv, .mp4, .m4v or .mov), the first by name; empty if there is none.
[[nodiscard]] std::filesystem::path find_video(const std::filesystem::path& folder);

}  // namespace gimbal
