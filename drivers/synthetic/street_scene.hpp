#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/synthetic/house.hpp"
#include "drivers/synthetic/random.hpp"
#include "drivers/synthetic/scene.hpp"

namespace gimbal {

/// A street seen by a person who stands in it, as a panorama: gabled houses on both sides, a church
/// at its end, lamp posts, trees and cars, on a level ground and under clouds. Straight lines run
/// in all directions, there is texture at all scales, and no two bricks, panes or leaves are alike.
/// The street leads away 20 degrees to the right of the world's x.
class StreetScene : public Scene {
 public:
  /// Detail finer than `finest_rad` (the angle of a pixel) is left out, for it would alias.
  StreetScene(std::uint64_t seed, double finest_rad);

  [[nodiscard]] Eigen::Vector3d color(const Eigen::Vector3d& direction_world) const override;

 private:
  struct Post {
    double along_m, left_m, height_m;
  };
  struct Tree {
    double along_m = 0;
    double left_m = 0;
    double crown_m = 0;   ///< radius
    double height_m = 0;  ///< of the crown's middle
    std::uint64_t salt = 0;
  };
  struct Car {
    double along_m, left_m;
    Eigen::Vector3d paint;
  };
  /// What a look meets, and how far away.
  struct Hit {
    double distance_m;
    Eigen::Vector3d color;
  };

  void plant(const Eigen::Vector2d& place_m, Random& random);

  // All take a unit vector in street axes: along, left, up.
  [[nodiscard]] std::optional<Hit> hit_post(const Eigen::Vector3d& look) const;
  [[nodiscard]] std::optional<Hit> hit_tree(const Eigen::Vector3d& look) const;
  [[nodiscard]] std::optional<Hit> hit_car(const Eigen::Vector3d& look) const;
  [[nodiscard]] std::optional<Hit> hit_houses(const Eigen::Vector3d& look) const;
  [[nodiscard]] std::optional<Hit> hit_end(const Eigen::Vector3d& look) const;
  [[nodiscard]] std::optional<Hit> hit_ground(const Eigen::Vector3d& look) const;
  [[nodiscard]] Eigen::Vector3d sky(const Eigen::Vector3d& look) const;

  std::uint64_t seed_;
  double finest_rad_;
  std::vector<House> left_row_;
  std::vector<House> right_row_;
  std::vector<House> end_row_;
  std::vector<Post> posts_;
  std::vector<Tree> trees_;
  std::vector<Car> cars_;
};

}  // namespace gimbal
