#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace gimbal {

/// A house as part of a row: a flat front with a gable, windows and a door.
struct House {
  double begin_m = 0;  ///< along the row
  double end_m = 0;
  double eaves_m = 0;   ///< height where the gable begins
  double gable_m = 0;   ///< height of the gable above that
  int gable_steps = 0;  ///< 0 for straight slopes
  int floors = 1;
  int windows = 1;           ///< a floor
  Eigen::Vector3d wall;      ///< linear light
  Eigen::Vector3d woodwork;  ///< of the door
  std::uint64_t salt = 0;    ///< what makes its bricks and curtains its own
};

/// A point on a front, and what one sample there covers.
struct FrontPoint {
  double along_m = 0;  ///< along the row
  double up_m = 0;     ///< above the ground
  double grain_m = 0;  ///< width that a sample covers; finer detail is left out
};

/// Houses side by side from `begin_m` to at least `end_m`.
[[nodiscard]] std::vector<House> build_row(double begin_m, double end_m, std::uint64_t seed);

/// The house at a place along a row; the nearest end's where there is none.
[[nodiscard]] const House& house_at(const std::vector<House>& row, double along_m);

/// Height of the front there.
[[nodiscard]] double roof_line(const House& house, double along_m);

/// Linear light of the front in full daylight. Precondition: below the roof line.
[[nodiscard]] Eigen::Vector3d front_color(const House& house, const FrontPoint& point);

}  // namespace gimbal
