#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <numbers>

namespace gimbal {

/// Whether a view keeps its horizon level. World z is up.
enum class Horizon : std::uint8_t {
  off,
  soft,  ///< levels as steadily as it does everything else, and gives way to the frame's edge
  hard,  ///< level at all times, as far as the frame reaches
};

struct HorizonLock {
  Horizon horizon = Horizon::off;
  double most_roll_rad = std::numbers::pi / 4;  ///< what a camera rolls beyond is left in the view

  bool operator==(const HorizonLock&) const = default;
};

/// How far the camera rolls clockwise about its own axis, from level; 0 where it looks straight up
/// or down.
[[nodiscard]] double roll_rad(const Eigen::Quaterniond& q_world_camera);

/// The same direction without the roll, as far as the lock goes. Within 20 degrees of straight up
/// or down, where a small turn rolls the horizon right round, ever less of it is taken out.
[[nodiscard]] Eigen::Quaterniond levelled(const Eigen::Quaterniond& q_world_camera,
                                          double most_roll_rad);

/// How the roll changes as the camera turns about the world's axes, less of it near straight up and
/// down: zero where there is no horizon.
[[nodiscard]] Eigen::Vector3d roll_per_turn(const Eigen::Quaterniond& q_world_camera);

}  // namespace gimbal
