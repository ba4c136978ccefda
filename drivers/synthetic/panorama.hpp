#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "drivers/synthetic/scene.hpp"

namespace gimbal {

/// Unit rays of a line of pixels in camera axes, one array a coordinate.
struct RayLine {
  std::span<const float> x;
  std::span<const float> y;
  std::span<const float> z;
};

/// A scene sampled once so that it can be looked at quickly: a cube map in linear light whose
/// texels are nearly even in angle, read bilinearly. It is made in tiles, each when it is first
/// seen. What a camera sees is defined by this map, so that pictures drawn from it agree exactly
/// with each other.
class Panorama {
 public:
  /// `texels_per_radian`: as many as the sharpest camera has pixels a radian (its focal length), so
  /// that nothing aliases. Each texel averages `samples_per_texel_side` squared looks at the scene.
  Panorama(std::shared_ptr<const Scene> scene, double texels_per_radian,
           int samples_per_texel_side);
  Panorama(const Panorama&) = delete;
  Panorama& operator=(const Panorama&) = delete;
  ~Panorama();

  /// Adds what each ray sees, times `weight`, to `light`, one a ray. Threads may share a panorama.
  void add_light(const RayLine& rays, const Eigen::Matrix3f& R_world_camera, float weight,
                 std::span<Light> light) const;

 private:
  static constexpr int kTileSide = 64;
  static constexpr int kNodeSide = kTileSide + 1;  // neighbours share their edge's texels

  using Tile = std::array<Light, std::size_t{kNodeSide} * kNodeSide>;

  [[nodiscard]] static constexpr std::size_t node(int column, int row) {
    return static_cast<std::size_t>(row) * kNodeSide + static_cast<std::size_t>(column);
  }

  struct TilePlace {
    int face;
    int column;
    int row;
  };

  [[nodiscard]] const Tile& tile(const TilePlace& place) const;
  [[nodiscard]] std::unique_ptr<const Tile> make_tile(const TilePlace& place) const;
  [[nodiscard]] Light look(int face, double column, double row) const;
  [[nodiscard]] Light sample(const Eigen::Vector3f& direction) const;

  std::shared_ptr<const Scene> scene_;
  int samples_per_side_;
  int tiles_per_side_;
  float texels_per_side_;
  mutable std::vector<std::atomic<const Tile*>> tiles_;
};

}  // namespace gimbal
