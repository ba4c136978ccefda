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

/// A texel's code is the square root of its light.
constexpr std::array<float, 256> make_light_of_code() {
  std::array<float, 256> light{};
  for (std::size_t code = 0; code < light.size(); ++code) {
    const float root = static_cast<float>(code) / 255.0F;
    light[code] = root * root;
  }
  return light;
}

constexpr std::array<float, 256> kLightOfCode = make_light_of_code();

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

Panorama::Texel Panorama::look(int face, double column, double row) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const double scale = 2.0 / static_cast<double>(texels_per_side_);
  for (int i = 0; i < samples_per_side_ * samples_per_side_; ++i) {
    const double dx = (i % samples_per_side_ + 0.5) / samples_per_side_ - 0.5;
    const double dy = (i / samples_per_side_ + 0.5) / samples_per_side_ - 0.5;
    const double a = tangent_from_even((column + dx) * scale - 1.0);
    const double b = tangent_from_even((row + dy) * scale - 1.0);
    sum += scene_->color(face_direction(face, a, b));
  }
  const Eigen::Array3d mean = sum.array() / (samples_per_side_ * samples_per_side_);
  const Eigen::Array3d code = mean.max(0.0).min(1.0).sqrt() * 255.0 + 0.5;
  return {static_cast<std::uint8_t>(code[0]), static_cast<std::uint8_t>(code[1]),
          static_cast<std::uint8_t>(code[2]), 0};
}

std::unique_ptr<const Panorama::Tile> Panorama::make_tile(const TilePlace& place) const {
  auto tile = std::make_unique<Tile>();
  for (int y = 0; y < kNodeSide; ++y) {
    for (int x = 0; x < kNodeSide; ++x) {
      (*tile)[static_cast<std::size_t>(y * kNodeSide + x)] =
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

Eigen::Vector3f Panorama::sample(const Eigen::Vector3f& direction) const {
  const float ax = std::abs(direction.x());
  const float ay = std::abs(direction.y());
  const float az = std::abs(direction.z());
  const int major = az >= ax && az >= ay ? 2 : (ay >= ax ? 1 : 0);
  const float along = direction[major];
  if (along == 0.0F) return Eigen::Vector3f::Zero();  // a pixel that the lens does not reach
  const float inverse = 1.0F / std::abs(along);
  const int face = 2 * major + (along < 0.0F ? 1 : 0);
  const float half = 0.5F * texels_per_side_;
  const float limit = texels_per_side_ * (1.0F - 1e-6F);  // the far edge is the last texel's
  const float column =
      std::min(half * (1.0F + even_from_tangent(direction[(major + 1) % 3] * inverse)), limit);
  const float row =
      std::min(half * (1.0F + even_from_tangent(direction[(major + 2) % 3] * inverse)), limit);
  const int left = static_cast<int>(column);
  const int top = static_cast<int>(row);
  const Tile& map = tile({face, left / kTileSide, top / kTileSide});
  const Texel* texel =
      &map[static_cast<std::size_t>((top % kTileSide) * kNodeSide + left % kTileSide)];
  const float right_share = column - static_cast<float>(left);
  const float bottom_share = row - static_cast<float>(top);
  const float w11 = right_share * bottom_share;
  const float w01 = right_share - w11;
  const float w10 = bottom_share - w11;
  const float w00 = 1.0F - right_share - w10;
  const auto blend = [&](std::uint8_t Texel::*channel) {
    return w00 * kLightOfCode[texel[0].*channel] + w01 * kLightOfCode[texel[1].*channel] +
           w10 * kLightOfCode[texel[kNodeSide].*channel] +
           w11 * kLightOfCode[texel[kNodeSide + 1].*channel];
  };
  return {blend(&Texel::red), blend(&Texel::green), blend(&Texel::blue)};
}

void Panorama::add_light(const RayLine& rays, const Eigen::Matrix3f& R_world_camera, float weight,
                         std::span<Eigen::Vector3f> light) const {
  for (std::size_t i = 0; i < light.size(); ++i) {
    light[i] += weight * sample(R_world_camera * Eigen::Vector3f(rays.x[i], rays.y[i], rays.z[i]));
  }
}

}  // namespace gimbal
