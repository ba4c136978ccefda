#include "drivers/synthetic/house.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "drivers/synthetic/procedural_noise.hpp"
#include "drivers/synthetic/random.hpp"

namespace gimbal {
namespace {

using Color = Eigen::Vector3d;

constexpr double kGroundFloor_m = 3.6;
constexpr double kFloor_m = 3.1;
constexpr double kBrickWidth_m = 0.25;
constexpr double kBrickHeight_m = 0.09;

const Color kFrame(0.78, 0.76, 0.70);
const Color kGlass(0.035, 0.045, 0.06);
const Color kSkyInGlass(0.30, 0.38, 0.48);
const Color kCurtain(0.55, 0.52, 0.46);
const Color kStone(0.42, 0.40, 0.37);

Color pick_wall(Random& random) {
  static const std::array<Color, 9> kWalls = {
      Color(0.30, 0.09, 0.055), Color(0.38, 0.16, 0.09), Color(0.20, 0.075, 0.06),
      Color(0.55, 0.42, 0.22),  Color(0.62, 0.60, 0.55), Color(0.24, 0.26, 0.30),
      Color(0.48, 0.30, 0.17),  Color(0.34, 0.40, 0.36), Color(0.16, 0.11, 0.10)};
  const auto index =
      static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(kWalls.size())));
  return kWalls[index] * random.uniform(0.85, 1.1);
}

Color pick_woodwork(Random& random) {
  static const std::array<Color, 5> kPaints = {Color(0.02, 0.08, 0.05), Color(0.10, 0.02, 0.02),
                                               Color(0.02, 0.04, 0.12), Color(0.03, 0.03, 0.03),
                                               Color(0.25, 0.14, 0.06)};
  return kPaints[static_cast<std::size_t>(
      random.uniform(0.0, static_cast<double>(kPaints.size())))];
}

/// A window or door: a hole with a frame. `across` and `up` run from its lower left corner.
struct Opening {
  double width_m;
  double height_m;
  double across_m;
  double up_m;
  std::uint64_t salt;

  [[nodiscard]] bool holds(double margin_m) const {
    return across_m > -margin_m && across_m < width_m + margin_m && up_m > -margin_m &&
           up_m < height_m + margin_m;
  }
};

/// Bars between panes: an upright in the middle and a cross piece at two thirds.
bool on_glazing_bar(const Opening& window) {
  constexpr double kBar_m = 0.035;
  return std::abs(window.across_m - 0.5 * window.width_m) < kBar_m ||
         std::abs(window.up_m - 0.66 * window.height_m) < kBar_m;
}

Color glass_color(const Opening& window, double grain_m) {
  const double chance = lattice_random(1, 2, window.salt);
  const double drawn = chance < 0.35 ? 0.2 + 0.6 * lattice_random(3, 4, window.salt) : 0.0;
  const double from_side = std::min(window.across_m, window.width_m - window.across_m);
  const bool behind_curtain = from_side < 0.5 * drawn * window.width_m;
  const double folds = 0.85 + 0.15 * value_noise(window.across_m * 14.0, 0.0, window.salt);
  if (behind_curtain) return folds * kCurtain;
  const double reflection =
      0.35 + 0.3 * lattice_random(5, 6, window.salt) +
      0.35 * fractal_noise(window.across_m * 1.5, window.up_m * 1.5, 4, 1.5 * grain_m, window.salt);
  return kGlass + std::clamp(reflection, 0.0, 1.0) * (window.up_m / window.height_m) * kSkyInGlass;
}

Color window_color(const Opening& window, double grain_m) {
  if (!window.holds(0.0) || !window.holds(-0.07) || on_glazing_bar(window)) return kFrame;
  const bool shaded = window.up_m > window.height_m - 0.2;  // by the lintel
  return (shaded ? 0.45 : 1.0) * glass_color(window, grain_m);
}

Color door_color(const House& house, const Opening& door) {
  if (!door.holds(0.0) || !door.holds(-0.08)) return kFrame;
  if (door.up_m > door.height_m - 0.55) return kGlass + 0.3 * kSkyInGlass;
  const double panel_x = std::abs(door.across_m - 0.5 * door.width_m);
  const double panel_y = std::fmod(door.up_m, 0.95);
  const bool sunk = panel_x > 0.08 && panel_x < 0.36 && panel_y > 0.2 && panel_y < 0.85;
  return (sunk ? 0.6 : 1.0) * house.woodwork;
}

/// Bricks with mortar, each burnt differently; a plain mean where they are finer than a sample.
double brick_light(const House& house, const FrontPoint& point) {
  const double row = std::floor(point.up_m / kBrickHeight_m);
  const double shift = std::fmod(std::abs(row), 2.0) * 0.5;
  const double column = point.along_m / kBrickWidth_m + shift;
  const double burnt = lattice_random(static_cast<std::int64_t>(std::floor(column)),
                                      static_cast<std::int64_t>(row), house.salt);
  const bool mortar =
      point.up_m / kBrickHeight_m - row < 0.14 || column - std::floor(column) < 0.05;
  const double visible = 1.0 - smooth_step(0.25, 1.2, point.grain_m / kBrickHeight_m);
  return 1.0 + visible * (mortar ? 0.35 : 0.55 * (burnt - 0.5));
}

Color wall_color(const House& house, const FrontPoint& point) {
  const double stains =
      fractal_noise(point.along_m / 3.0, point.up_m / 3.0, 7, point.grain_m / 3.0, house.salt);
  const double damp = 0.75 + 0.25 * smooth_step(0.0, 1.2, point.up_m);
  return (1.0 + 0.22 * stains) * damp * brick_light(house, point) * house.wall;
}

/// Floor that a height lies on, and the height above that floor's ground.
struct Storey {
  int index;
  double up_m;
};

Storey storey_of(double up_m) {
  if (up_m < kGroundFloor_m) return {0, up_m};
  const int above = static_cast<int>((up_m - kGroundFloor_m) / kFloor_m);
  return {above + 1, up_m - kGroundFloor_m - above * kFloor_m};
}

std::uint64_t salt_of(const House& house, int storey, int bay) {
  return stream_seed(house.salt,
                     static_cast<std::uint64_t>(storey) * 64 + static_cast<std::uint64_t>(bay));
}

}  // namespace

std::vector<House> build_row(double begin_m, double end_m, std::uint64_t seed) {
  Random random(seed);
  std::vector<House> row;
  double at_m = begin_m;
  while (at_m < end_m) {
    House house;
    house.begin_m = at_m;
    house.end_m = at_m + random.uniform(5.0, 9.0);
    house.floors = static_cast<int>(random.uniform(2.0, 5.0));
    house.eaves_m = kGroundFloor_m + house.floors * kFloor_m - random.uniform(0.0, 0.5);
    house.gable_m = random.uniform(0.0, 1.0) < 0.25 ? 0.4 : random.uniform(2.0, 4.2);
    house.gable_steps = random.uniform() < 0.4 ? static_cast<int>(random.uniform(4.0, 8.0)) : 0;
    house.windows = static_cast<int>((house.end_m - house.begin_m) / random.uniform(1.9, 2.5));
    house.wall = pick_wall(random);
    house.woodwork = pick_woodwork(random);
    house.salt = stream_seed(seed, row.size());
    row.push_back(house);
    at_m = house.end_m;
  }
  return row;
}

const House& house_at(const std::vector<House>& row, double along_m) {
  const auto next = std::ranges::upper_bound(row, along_m, {}, &House::begin_m);
  return next == row.begin() ? row.front() : *std::prev(next);
}

double roof_line(const House& house, double along_m) {
  const double middle = 0.5 * (house.begin_m + house.end_m);
  const double half = 0.5 * (house.end_m - house.begin_m);
  double share = std::clamp(1.0 - std::abs(along_m - middle) / half, 0.0, 1.0);
  if (house.gable_m < 1.0) share = 1.0;  // a flat roof with a parapet
  if (house.gable_steps > 0) {
    share = std::ceil(share * house.gable_steps) / house.gable_steps;
  }
  return house.eaves_m + share * house.gable_m;
}

Color front_color(const House& house, const FrontPoint& point) {
  const double below_roof = roof_line(house, point.along_m) - point.up_m;
  if (below_roof < 0.22)
    return kStone * (1.0 + 0.15 * value_noise(point.along_m * 3.0, 0, house.salt));
  const bool on_cornice = std::abs(point.up_m - house.eaves_m) < 0.14;
  if (on_cornice) return kFrame * 0.8;
  if (point.up_m > house.eaves_m) {
    const Opening attic{0.9, 1.3, point.along_m - 0.5 * (house.begin_m + house.end_m) + 0.45,
                        point.up_m - house.eaves_m - 0.45, salt_of(house, 50, 0)};
    return house.gable_m > 2.5 && attic.holds(0.09) ? window_color(attic, point.grain_m)
                                                    : wall_color(house, point);
  }
  const Storey storey = storey_of(point.up_m);
  const double bay_m = (house.end_m - house.begin_m) / house.windows;
  const double from_begin_m = point.along_m - house.begin_m;
  const int bay = std::clamp(static_cast<int>(from_begin_m / bay_m), 0, house.windows - 1);
  const double in_bay_m = from_begin_m - bay * bay_m;
  const int door_bay = static_cast<int>(lattice_random(0, 0, house.salt) * house.windows);
  if (storey.index == 0 && bay == door_bay) {
    const Opening door{1.15, 2.75, in_bay_m - 0.5 * (bay_m - 1.15), storey.up_m - 0.2, house.salt};
    if (door.holds(0.1)) return door_color(house, door);
  } else {
    const double width_m = std::min(1.25, 0.62 * bay_m);
    const double height_m = storey.index == 0 ? 1.9 : 1.95 - 0.12 * storey.index;
    const Opening window{width_m, height_m, in_bay_m - 0.5 * (bay_m - width_m), storey.up_m - 0.85,
                         salt_of(house, storey.index, bay)};
    const bool on_sill = std::abs(window.across_m - 0.5 * width_m) < 0.5 * width_m + 0.15 &&
                         window.up_m < -0.09 && window.up_m > -0.22;
    if (on_sill) return kStone;
    const bool fits = house.eaves_m - point.up_m + window.up_m > height_m + 0.2;
    if (fits && window.holds(0.09)) return window_color(window, point.grain_m);
  }
  return point.up_m < 0.6 ? Color(kStone * 0.55 * brick_light(house, point))
                          : wall_color(house, point);
}

}  // namespace gimbal
