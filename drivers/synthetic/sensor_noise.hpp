#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "drivers/synthetic/scene.hpp"

namespace gimbal {

/// Photon (shot) and read noise of a pixel.
struct PixelNoise {
  double full_well_electrons = 8000;  ///< charge that linear light 1 makes: less is noisier
  double read_noise_electrons = 4;    ///< rms
};

/// Adds the noise of a sensor to linear light: its variance is (light x full well + read²) / full
/// well² (Poisson's by its normal limit).
class SensorNoise {
 public:
  explicit SensorNoise(const PixelNoise& noise);

  /// The same `seed` makes the same noise.
  void add(std::span<Light> light, std::uint64_t seed) const;

 private:
  float per_light_;
  float floor_;
  /// Normal deviates to draw from: a draw costs a look-up, and a frame needs millions.
  std::vector<float> deviates_;
};

}  // namespace gimbal
