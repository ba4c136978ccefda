#include "pipeline/path/horizon.hpp"

#include <cmath>

#include "pipeline/sample/smooth_step.hpp"

namespace gimbal {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// Sines of the angle from straight up or down: 6 and 20 degrees.
constexpr double kNoHorizon = 0.1;
constexpr double kSureHorizon = 0.34;

/// How much of a roll is taken out: all of it within the lock, then ever less until none is of a
/// camera that hangs upside down, where left and right are one.
double taken_out(double roll, double most_roll_rad) {
  const double beyond = std::abs(roll) - most_roll_rad;
  if (beyond <= 0) return roll;
  return std::copysign(most_roll_rad * (1 - beyond / (std::numbers::pi - most_roll_rad)), roll);
}

/// The world's up in camera axes; a level camera sees it at -y.
Vector3d up_in(const Quaterniond& q_world_camera) {
  return q_world_camera.conjugate() * Vector3d::UnitZ();
}

double certainty_of(const Vector3d& up) {
  return smooth_step((up.head<2>().norm() - kNoHorizon) / (kSureHorizon - kNoHorizon));
}

}  // namespace

double roll_rad(const Quaterniond& q_world_camera) {
  const Vector3d up = up_in(q_world_camera);
  constexpr double kNoDirection = 1e-9;
  if (up.head<2>().norm() < kNoDirection) return 0;
  return std::atan2(-up.x(), -up.y());
}

Quaterniond levelled(const Quaterniond& q_world_camera, double most_roll_rad) {
  const double certainty = certainty_of(up_in(q_world_camera));
  const double roll = taken_out(roll_rad(q_world_camera), most_roll_rad);
  return q_world_camera * Eigen::AngleAxisd(-certainty * roll, Vector3d::UnitZ());
}

Vector3d roll_per_turn(const Quaterniond& q_world_camera) {
  const Vector3d up = up_in(q_world_camera);
  const double certainty = certainty_of(up);
  if (certainty == 0) return Vector3d::Zero();
  Vector3d per_turn;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d moved =
        q_world_camera.conjugate() * Vector3d::UnitZ().cross(Vector3d::Unit(axis));
    per_turn[axis] = up.y() * moved.x() - up.x() * moved.y();
  }
  return certainty / up.head<2>().squaredNorm() * per_turn;
}

}  // namespace gimbal
