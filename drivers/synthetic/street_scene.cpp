#include "drivers/synthetic/street_scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "drivers/synthetic/procedural_noise.hpp"
#include "drivers/synthetic/random.hpp"

namespace gimbal {
namespace {

using Color = Eigen::Vector3d;
using Look = Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kStreetHeading = -20.0 * kDegree;
constexpr double kEye_m = 1.65;
constexpr double kLeftFronts_m = 9.0;
constexpr double kRightFronts_m = -8.0;
constexpr double kRoadEdge_m = 4.0;
constexpr double kCars_m = 3.1;  // from the street's axis
constexpr double kEndOfStreet_m = 110.0;
constexpr double kBackOfStreet_m = -70.0;
constexpr double kSunSlope = 1.45;  // height over width of shadows
constexpr double kChurch_m = 3.0;   // half the tower's width

const Color kAsphalt(0.10, 0.10, 0.105);
const Color kPavement(0.30, 0.285, 0.26);
const Color kKerb(0.36, 0.35, 0.33);
const Color kIron(0.025, 0.03, 0.03);
const Color kBark(0.09, 0.065, 0.045);
const Color kLeaf(0.10, 0.17, 0.035);
const Color kCloud(0.86, 0.87, 0.89);
const Color kZenith(0.10, 0.24, 0.52);
const Color kHorizon(0.52, 0.64, 0.76);
const Color kHaze(0.55, 0.63, 0.72);

Color in_haze(const Color& color, double distance_m) {
  const double clear = std::exp(-distance_m / 400.0);
  return clear * color + (1.0 - clear) * kHaze;
}

/// Each part of the street has random numbers of its own.
std::uint64_t salt(std::uint64_t seed, std::uint64_t what) {
  return stream_seed(seed, 100 + what);
}

constexpr std::uint64_t kLeftRow = 0;
constexpr std::uint64_t kRightRow = 1;
constexpr std::uint64_t kEndRow = 2;
constexpr std::uint64_t kPlan = 3;
constexpr std::uint64_t kRoad = 4;
constexpr std::uint64_t kSlabs = 5;
constexpr std::uint64_t kSky = 6;
constexpr std::uint64_t kTower = 7;
constexpr std::uint64_t kTrees = 8;  // and one more for each tree

/// Where a look passes an upright thing, on the plane through it that faces the viewer.
struct Passing {
  double distance_m;  ///< along the look
  double aside_m;     ///< to the thing's left
  double up_m;        ///< above the ground
};

/// `forward` is the look's level part, of length 1. Nothing if the look goes the other way.
std::optional<Passing> pass(const Look& look, const Eigen::Vector2d& forward, double along_m,
                            double left_m) {
  const double forward_m = along_m * forward.x() + left_m * forward.y();
  if (forward_m <= 0.0) return std::nullopt;
  const double distance_m = forward_m / look.head<2>().dot(forward);
  const double aside_m = along_m * forward.y() - left_m * forward.x();
  return Passing{distance_m, aside_m, kEye_m + distance_m * look.z()};
}

/// Distance to an upright plane across one axis, if the look goes there.
std::optional<double> to_plane(double component, double place_m) {
  if (component * place_m <= 0.0) return std::nullopt;
  return place_m / component;
}

/// A church with a tower and a spire, as seen from the street.
double tower_top(double left_m) {
  const double from_axis = std::abs(left_m);
  if (from_axis > kChurch_m) return 0.0;
  return 27.0 + 14.0 * (1.0 - from_axis / kChurch_m);
}

Color tower_color(double left_m, double up_m, double grain_m, std::uint64_t tower_salt) {
  const double stains = fractal_noise(left_m, up_m, 5, grain_m, tower_salt);
  if (up_m > 27.2) return Color(0.10, 0.16, 0.14) * (1.0 + 0.3 * stains);
  if (up_m > 26.6) return Color(0.6, 0.58, 0.5);
  const double from_clock = std::hypot(left_m, up_m - 23.0);
  if (from_clock < 1.6) {
    const bool hand = std::abs(left_m) < 0.12 && up_m > 23.0 - 0.2;
    return from_clock > 1.35 || hand ? Color(0.45, 0.32, 0.05) : Color(0.03, 0.03, 0.04);
  }
  const bool louvre = std::abs(left_m) < 0.8 && up_m > 14.0 && up_m < 19.0;
  if (louvre) return Color(0.05, 0.05, 0.05) * (std::fmod(up_m, 0.8) < 0.4 ? 1.0 : 3.0);
  return Color(0.40, 0.33, 0.24) * (1.0 + 0.35 * stains);
}

struct Interval {
  double least;
  double most;
};

/// Places from one end of a stretch to the other, at random distances.
std::vector<double> places(const Interval& stretch_m, const Interval& distance_m, Random& random) {
  std::vector<double> along_m;
  double next_m = stretch_m.least;
  while (next_m < stretch_m.most) {
    along_m.push_back(next_m);
    next_m += random.uniform(distance_m.least, distance_m.most);
  }
  return along_m;
}

Color pick_paint(Random& random) {
  static const std::array<Color, 6> kPaints = {Color(0.32, 0.03, 0.03), Color(0.03, 0.07, 0.22),
                                               Color(0.45, 0.45, 0.44), Color(0.04, 0.04, 0.045),
                                               Color(0.05, 0.16, 0.13), Color(0.50, 0.40, 0.14)};
  return kPaints[static_cast<std::size_t>(
      random.uniform(0.0, static_cast<double>(kPaints.size())))];
}

/// Paint, glass and wheels of a car seen from its side; nothing beside its outline. From its middle
/// and the ground.
std::optional<Color> car_color(double along_m, double up_m, const Color& paint) {
  const double from_wheel = std::hypot(std::abs(along_m) - 1.25, up_m - 0.31);
  if (from_wheel < 0.31)
    return from_wheel < 0.17 ? Color(0.30, 0.30, 0.31) : Color(0.02, 0.02, 0.02);
  const bool body = std::abs(along_m) < 2.05 && up_m > 0.25 && up_m < 0.85;
  const double cabin_half = 1.35 - 0.75 * std::max(0.0, up_m - 0.85);
  const bool cabin = std::abs(along_m + 0.15) < cabin_half && up_m >= 0.85 && up_m < 1.45;
  if (!body && !cabin) return std::nullopt;
  if (from_wheel < 0.36) return Color(0.01, 0.01, 0.01);
  const bool pane = cabin && up_m < 1.36 && std::abs(along_m + 0.15) < cabin_half - 0.09 &&
                    std::abs(along_m + 0.1) > 0.05;
  if (pane) return Color(0.05, 0.07, 0.09) + (up_m - 0.85) * Color(0.2, 0.26, 0.32);
  if (std::abs(along_m) > 1.92 && up_m > 0.58 && up_m < 0.72) return Color(0.55, 0.12, 0.06);
  const bool seam = std::abs(std::abs(along_m + 0.1) - 0.9) < 0.012 || std::abs(up_m - 0.5) < 0.01;
  return (seam ? 0.3 : 0.7 + 0.5 * up_m) * paint;
}

/// A lamp post with a lantern on top; nothing beside its outline.
std::optional<Color> post_color(double aside_m, double up_m, double height_m) {
  constexpr double kRadius_m = 0.055;
  if (up_m < 0.0 || up_m > height_m + 0.62) return std::nullopt;
  const bool lantern = up_m > height_m;
  const bool foot = up_m < 0.9;
  const bool ring = std::abs(up_m - 2.9) < 0.05;
  const double half_m =
      lantern ? 0.17 + 0.1 * (up_m - height_m) : kRadius_m * (foot ? 1.9 : (ring ? 1.6 : 1.0));
  if (std::abs(aside_m) > half_m) return std::nullopt;
  const bool glass = lantern && up_m < height_m + 0.5 && up_m > height_m + 0.06;
  if (glass) return Color(0.75, 0.72, 0.60);
  const double roundness = 1.0 - 0.75 * std::abs(aside_m / half_m + 0.3);
  return kIron * (1.0 + 3.0 * roundness);
}

/// Leaves around a crown's middle; nothing between and beside them.
std::optional<Color> crown_color(double aside_m, double up_m, double grain_m, double crown_m,
                                 std::uint64_t tree_salt) {
  const double from_middle_m = std::hypot(aside_m, up_m);
  if (from_middle_m > 1.5 * crown_m) return std::nullopt;
  const double ragged =
      1.0 + 0.35 * fractal_noise(aside_m * 1.2, up_m * 1.2, 6, 1.2 * grain_m, tree_salt);
  if (from_middle_m > crown_m * ragged) return std::nullopt;
  const double leaves = fractal_noise(aside_m * 4.0, up_m * 4.0, 5, 4.0 * grain_m, tree_salt + 1);
  const double lit = 0.9 + 0.45 * up_m / crown_m - 0.15 * aside_m / crown_m;
  return kLeaf * std::max(0.15, lit * (1.0 + 0.9 * leaves));
}

Color road_color(double along_m, double left_m, double grain_m, std::uint64_t road_salt) {
  const double wear =
      fractal_noise(along_m / 4.0, left_m / 1.5, 8, grain_m / 1.5, road_salt) +
      0.6 * fractal_noise(along_m * 9.0, left_m * 9.0, 3, 9.0 * grain_m, road_salt + 1);
  const bool dash = std::abs(left_m) < 0.07 && std::fmod(along_m - kBackOfStreet_m, 6.0) < 2.6;
  if (dash && wear < 0.6) return {0.55, 0.55, 0.52};
  return kAsphalt * (1.0 + 0.45 * wear);
}

/// Slabs with gaps, each its own tone.
Color pavement_color(double along_m, double left_m, double grain_m, std::uint64_t slab_salt) {
  constexpr double kSlab_m = 0.6;
  const double column = std::floor(along_m / kSlab_m);
  const double row = std::floor(left_m / kSlab_m);
  const double tone =
      lattice_random(static_cast<std::int64_t>(column), static_cast<std::int64_t>(row), slab_salt);
  const bool gap = std::min(along_m / kSlab_m - column, left_m / kSlab_m - row) < 0.03;
  const double visible = 1.0 - smooth_step(0.2, 1.0, grain_m / kSlab_m);
  const double dirt = fractal_noise(along_m, left_m, 6, grain_m, slab_salt);
  return (1.0 + visible * (gap ? -0.5 : 0.35 * (tone - 0.5)) + 0.25 * dirt) * kPavement;
}

}  // namespace

StreetScene::StreetScene(std::uint64_t seed, double finest_rad)
    : seed_(seed),
      finest_rad_(finest_rad),
      left_row_(build_row(kBackOfStreet_m, kEndOfStreet_m, salt(seed, kLeftRow))),
      right_row_(build_row(kBackOfStreet_m, kEndOfStreet_m, salt(seed, kRightRow))),
      end_row_(build_row(-30.0, 30.0, salt(seed, kEndRow))) {
  Random random(salt(seed, kPlan));
  for (const double along_m : places({-40.0, 90.0}, {13.0, 17.0}, random)) {
    posts_.push_back({along_m, 4.7, 4.4});
    posts_.push_back({along_m + random.uniform(4.0, 8.0), -4.7, 4.4});
  }
  for (const double along_m : places({-44.0, 90.0}, {16.0, 26.0}, random)) {
    plant({along_m, 5.6}, random);
    plant({along_m + random.uniform(6.0, 12.0), -5.4}, random);
  }
  for (const double along_m : places({-38.0, 80.0}, {5.2, 14.0}, random)) {
    const double side_m = random.uniform() < 0.6 ? kCars_m : -kCars_m;
    cars_.push_back({along_m, side_m, pick_paint(random)});
  }
}

void StreetScene::plant(const Eigen::Vector2d& place_m, Random& random) {
  Tree tree{place_m.x(), place_m.y()};
  tree.crown_m = random.uniform(1.2, 1.9);
  tree.height_m = random.uniform(4.6, 6.2);
  tree.salt = salt(seed_, kTrees + trees_.size());
  trees_.push_back(tree);
}

Eigen::Vector3d StreetScene::color(const Eigen::Vector3d& direction_world) const {
  const Look look = Eigen::AngleAxisd(-kStreetHeading, Eigen::Vector3d::UnitZ()) * direction_world;
  std::optional<Hit> nearest;
  for (const std::optional<Hit>& hit : {hit_post(look), hit_tree(look), hit_car(look),
                                        hit_houses(look), hit_end(look), hit_ground(look)}) {
    if (hit && (!nearest || hit->distance_m < nearest->distance_m)) nearest = hit;
  }
  return nearest ? in_haze(nearest->color, nearest->distance_m) : sky(look);
}

std::optional<StreetScene::Hit> StreetScene::hit_post(const Look& look) const {
  const Eigen::Vector2d forward = look.head<2>().normalized();
  std::optional<Hit> nearest;
  for (const Post& post : posts_) {
    const std::optional<Passing> at = pass(look, forward, post.along_m, post.left_m);
    if (!at || std::abs(at->aside_m) > 0.3 || (nearest && nearest->distance_m < at->distance_m)) {
      continue;
    }
    const std::optional<Color> color = post_color(at->aside_m, at->up_m, post.height_m);
    if (color) nearest = Hit{at->distance_m, *color};
  }
  return nearest;
}

std::optional<StreetScene::Hit> StreetScene::hit_tree(const Look& look) const {
  const Eigen::Vector2d forward = look.head<2>().normalized();
  std::optional<Hit> nearest;
  for (const Tree& tree : trees_) {
    const std::optional<Passing> at = pass(look, forward, tree.along_m, tree.left_m);
    if (!at || std::abs(at->aside_m) > 1.5 * tree.crown_m) continue;
    if (nearest && nearest->distance_m < at->distance_m) continue;
    const double grain_m = finest_rad_ * at->distance_m;
    const double above_m = at->up_m - tree.height_m;
    const std::optional<Color> leaves =
        crown_color(at->aside_m, above_m, grain_m, tree.crown_m, tree.salt);
    const bool trunk = std::abs(at->aside_m) < 0.13 && at->up_m > 0.0 && above_m < 0.0;
    if (leaves) {
      nearest = Hit{at->distance_m, *leaves};
    } else if (trunk) {
      const double bark = fractal_noise(at->aside_m * 20, at->up_m * 3, 3, 20 * grain_m, tree.salt);
      nearest = Hit{at->distance_m, kBark * (1.0 + 0.5 * bark)};
    }
  }
  return nearest;
}

std::optional<StreetScene::Hit> StreetScene::hit_car(const Look& look) const {
  if (look.z() > 0.0) return std::nullopt;
  for (const double left_m : {kCars_m, -kCars_m}) {
    const std::optional<double> distance_m = to_plane(look.y(), left_m);
    if (!distance_m) continue;
    const double along_m = *distance_m * look.x();
    const double up_m = kEye_m + *distance_m * look.z();
    for (const Car& car : cars_) {
      if (car.left_m != left_m || std::abs(along_m - car.along_m) > 2.2) continue;
      const std::optional<Color> color = car_color(along_m - car.along_m, up_m, car.paint);
      if (color) return Hit{*distance_m, *color};
    }
  }
  return std::nullopt;
}

std::optional<StreetScene::Hit> StreetScene::hit_houses(const Look& look) const {
  const bool left = look.y() > 0.0;
  const std::optional<double> distance_m =
      to_plane(look.y(), left ? kLeftFronts_m : kRightFronts_m);
  if (!distance_m) return std::nullopt;
  const double along_m = *distance_m * look.x();
  const double up_m = kEye_m + *distance_m * look.z();
  if (along_m < kBackOfStreet_m || along_m > kEndOfStreet_m || up_m < 0.0) return std::nullopt;
  const House& house = house_at(left ? left_row_ : right_row_, along_m);
  if (up_m > roof_line(house, along_m)) return std::nullopt;
  const double grain_m = finest_rad_ * *distance_m / std::max(std::abs(look.y()), 0.05);
  const double sun = left ? 1.15 : 0.42;  // it stands to the right of the street
  return Hit{*distance_m, sun * front_color(house, {along_m, up_m, grain_m})};
}

std::optional<StreetScene::Hit> StreetScene::hit_end(const Look& look) const {
  const bool ahead = look.x() > 0.0;
  const std::optional<double> distance_m =
      to_plane(look.x(), ahead ? kEndOfStreet_m : kBackOfStreet_m);
  if (!distance_m) return std::nullopt;
  const double left_m = *distance_m * look.y();
  const double up_m = kEye_m + *distance_m * look.z();
  if (up_m < 0.0) return std::nullopt;
  const double grain_m = finest_rad_ * *distance_m / std::abs(look.x());
  if (ahead && up_m < tower_top(left_m)) {
    return Hit{*distance_m, tower_color(left_m, up_m, grain_m, salt(seed_, kTower))};
  }
  if (std::abs(left_m) > 29.0) return std::nullopt;
  const House& house = house_at(end_row_, left_m);
  if (up_m > roof_line(house, left_m)) return std::nullopt;
  return Hit{*distance_m, 0.8 * front_color(house, {left_m, up_m, grain_m})};
}

std::optional<StreetScene::Hit> StreetScene::hit_ground(const Look& look) const {
  const std::optional<double> distance_m = to_plane(look.z(), -kEye_m);
  if (!distance_m) return std::nullopt;
  const double along_m = *distance_m * look.x();
  const double left_m = *distance_m * look.y();
  // Foreshortened along the look only: the mean of both ways is neither blurred nor aliased.
  const double grain_m = finest_rad_ * *distance_m / std::sqrt(std::max(-look.z(), 1e-3));
  const double roof_m = roof_line(house_at(right_row_, along_m), along_m);
  const double shade = roof_m > kSunSlope * (left_m - kRightFronts_m) ? 0.42 : 1.0;
  const double from_axis_m = std::abs(left_m);
  Color color = kKerb;
  if (from_axis_m < kRoadEdge_m) {
    color = road_color(along_m, left_m, grain_m, salt(seed_, kRoad));
  } else if (from_axis_m > kRoadEdge_m + 0.18) {
    color = pavement_color(along_m, left_m, grain_m, salt(seed_, kSlabs));
  }
  return Hit{*distance_m, shade * color};
}

Eigen::Vector3d StreetScene::sky(const Look& look) const {
  const double up = std::max(look.z(), 0.0);
  const Color blue = kHorizon + std::pow(up, 0.6) * (kZenith - kHorizon);
  const double flat = 1.0 / (up + 0.15);  // clouds lie on a plane overhead
  const double billow = fractal_noise(look.x() * flat * 1.3, look.y() * flat * 1.3, 8,
                                      1.3 * finest_rad_ * flat * flat, salt(seed_, kSky));
  const double cover = smooth_step(-0.05, 0.55, billow);
  const double shade = 0.80 + 0.20 * smooth_step(1.1, 0.2, billow);
  return (1.0 - cover) * blue + cover * shade * kCloud;
}

}  // namespace gimbal
