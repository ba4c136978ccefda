#include "drivers/synthetic/panorama.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace gimbal {
namespace {

constexpr int kFaces = 6;

// On a face, a in [-1, 1] is the tangent of the angle from the face's middle. Laying texels evenly
// in a(s - (s-1)|a|), with s = 4/pi, keeps their angle even to 15 % (an even tangent: to a factor
// of two) and needs no arc tangent.
constexpr double kStretch = 4.0 / std::numbers::pi;

float even_from_tangent(float a) {
  constexpr auto s = static_cast<float>(kStretch);
  return a * (s - (s - 1.0F) * std::abs(a));
}

double tangent_from_even(double e) {
  constexpr double s = kStretch;
  const double magnitude = std::abs(e);
  return std::copysign((s - std::sqrt(s * s - 4.0 * (s - 1.0) * magnitude)) / (2.0 * (s - 1.0)), e);
}

/// Faces 2m and 2m + 1 look along plus and minus axis m.
Eigen::Vector3d face_direction(int face, double a, double b) {
  const Eigen::Index major = face / 2;
  Eigen::Vector3d direction;
  direction[major] = face % 2 == 0 ? 1.0 : -1.0;
  direction[(major + 1) % 3] = a;
  direction[(major + 2) % 3] = b;
  return direction.normalized();
}

}  // namespace

Panorama::Panorama(std::shared_ptr<const Scene> scene, double texels_per_radian,
                   int samples_per_texel_side)
    : scene_(std::move(scene)),
      samples_per_side_(samples_per_texel_side),
      tiles_per_side_(
          static_cast<int>(std::ceil(texels_per_radian * std::numbers::pi / 2.0 / kTileSide))),
      texels_per_side_(static_cast<float>(tiles_per_side_ * kTileSide)),
      tiles_(static_cast<std::size_t>(kFaces) * static_cast<std::size_t>(tiles_per_side_) *
             static_cast<std::size_t>(tiles_per_side_)) {}

Panorama::~Panorama() {
  for (const std::atomic<const Tile*>& slot : tiles_) delete slot.load();
}

Light Panorama::look(int face, double column, double row) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const double scale = 2.0 / static_cast<double>(texels_per_side_);
  const auto offset = [&](int i) { return (i + 0.5) / samples_per_side_ - 0.5; };
  for (int i = 0; i < samples_per_side_; ++i) {
    const double b = tangent_from_even((row + offset(i)) * scale - 1.0);
    for (int j = 0; j < samples_per_side_; ++j) {
      const double a = tangent_from_even((column + offset(j)) * scale - 1.0);
      sum += scene_->color(face_direction(face, a, b));
    }
  }
  const Eigen::Vector3d mean = sum / (samples_per_side_ * samples_per_side_);
  return {static_cast<float>(mean.x()), static_cast<float>(mean.y()), static_cast<float>(mean.z()),
          0.0F};
}

std::unique_ptr<const Panorama::Tile> Panorama::make_tile(const TilePlace& place) const {
  auto tile = std::make_unique<Tile>();
  for (int y = 0; y < kNodeSide; ++y) {
    for (int x = 0; x < kNodeSide; ++x) {
      (*tile)[node(x, y)] =
          look(place.face, place.column * kTileSide + x, place.row * kTileSide + y);
    }
  }
  return tile;
}

const Panorama::Tile& Panorama::tile(const TilePlace& place) const {
  const int index = (place.face * tiles_per_side_ + place.row) * tiles_per_side_ + place.column;
  std::atomic<const Tile*>& slot = tiles_[static_cast<std::size_t>(index)];
  if (const Tile* made = slot.load(std::memory_order_acquire)) return *made;
  // Two threads may make the same tile; the first one's is kept, and both are alike.
  std::unique_ptr<const Tile> fresh = make_tile(place);
  const Tile* kept = nullptr;
  if (slot.compare_exchange_strong(kept, fresh.get(), std::memory_order_acq_rel)) {
    return *fresh.release();
  }
  return *kept;
}

Light Panorama::sample(const Eigen::Vector3f& direction) const {
  const float ax = std::abs(direction.x());
  const float ay = std::abs(direction.y());
  const float az = std::abs(direction.z());
  // The axis that the direction is closest to, and the two that follow it in turn.
  const bool z_is_major = az >= ax && az >= ay;
  const bool y_is_major = !z_is_major && ay >= ax;
  const float along = z_is_major ? direction.z() : (y_is_major ? direction.y() : direction.x());
  const float a = z_is_major ? direction.x() : (y_is_major ? direction.z() : direction.y());
  const float b = z_is_major ? direction.y() : (y_is_major ? direction.x() : direction.z());
  if (along == 0.0F) return Light::Zero();  // a pixel that the lens does not reach
  const int major = z_is_major ? 2 : (y_is_major ? 1 : 0);
  const int face = 2 * major + (along < 0.0F ? 1 : 0);
  const float inverse = 1.0F / std::abs(along);
  const float half = 0.5F * texels_per_side_;
  const float limit = texels_per_side_ * (1.0F - 1e-6F);  // the far edge is the last texel's
  const float column = std::min(half + half * even_from_tangent(a * inverse), limit);
  const float row = std::min(half + half * even_from_tangent(b * inverse), limit);
  const int left = static_cast<int>(column);
  const int top = static_cast<int>(row);
  const Tile& map = tile({face, left / kTileSide, top / kTileSide});
  const Light* const texel = &map[node(left % kTileSide, top % kTileSide)];
  const float right_share = column - static_cast<float>(left);
  const float bottom_share = row - static_cast<float>(top);
  const Light upper = texel[0] + right_share * (texel[1] - texel[0]);
  const Light lower = texel[kNodeSide] + right_share * (texel[kNodeSide + 1] - texel[kNodeSide]);
  return upper + bottom_share * (lower - upper);
}

void Panorama::add_light(const RayLine& rays, const Eigen::Matrix3f& R_world_camera, float weight,
                         std::span<Light> light) const {
  for (std::size_t i = 0; i < light.size(); ++i) {
    const Eigen::Vector3f ray(rays.x[i], rays.y[i], rays.z[i]);
    light[i] += weight * sample(R_world_camera * ray);
  }
}

}  // namespace gimbal
