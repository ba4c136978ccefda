#include "drivers/synthetic/sensor_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "drivers/synthetic/random.hpp"

namespace gimbal {
namespace {

constexpr std::size_t kDeviates = 1U << 16U;  // an index is 16 random bits

}  // namespace

SensorNoise::SensorNoise(const PixelNoise& noise)
    : per_light_(static_cast<float>(1.0 / noise.full_well_electrons)),
      floor_(
          static_cast<float>(std::pow(noise.read_noise_electrons / noise.full_well_electrons, 2))) {
  Random random(kDeviates);
  deviates_.reserve(kDeviates);
  for (std::size_t i = 0; i < kDeviates; ++i)
    deviates_.push_back(static_cast<float>(random.normal()));
}

void SensorNoise::add(std::span<Light> light, std::uint64_t seed) const {
  for (std::size_t i = 0; i < light.size(); ++i) {
    const std::uint64_t bits = stream_seed(seed, i);
    const Light deviate(deviates_[bits & 0xffffU], deviates_[(bits >> 16U) & 0xffffU],
                        deviates_[(bits >> 32U) & 0xffffU], 0.0F);
    light[i] += (light[i].max(0.0F) * per_light_ + floor_).sqrt() * deviate;
  }
}

}  // namespace gimbal
