#include "drivers/synthetic/procedural_noise.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/synthetic/random.hpp"

namespace gimbal {

double lattice_random(std::int64_t x, std::int64_t y, std::uint64_t salt) {
  const std::uint64_t mixed =
      stream_seed(stream_seed(salt, static_cast<std::uint64_t>(x)), static_cast<std::uint64_t>(y));
  return static_cast<double>(mixed >> 11U) * 0x1p-53;
}

double value_noise(double x, double y, std::uint64_t salt) {
  const double left = std::floor(x);
  const double top = std::floor(y);
  const auto ease = [](double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); };
  const double right_share = ease(x - left);
  const double bottom_share = ease(y - top);
  const auto ix = static_cast<std::int64_t>(left);
  const auto iy = static_cast<std::int64_t>(top);
  const double upper =
      std::lerp(lattice_random(ix, iy, salt), lattice_random(ix + 1, iy, salt), right_share);
  const double lower = std::lerp(lattice_random(ix, iy + 1, salt),
                                 lattice_random(ix + 1, iy + 1, salt), right_share);
  return 2.0 * std::lerp(upper, lower, bottom_share) - 1.0;
}

double fractal_noise(double x, double y, int octaves, double footprint, std::uint64_t salt) {
  double sum = 0;
  double size = 1;
  for (int octave = 0; octave < octaves && size > footprint; ++octave) {
    const double visible = 1.0 - smooth_step(0.3, 1.0, footprint / size);
    sum +=
        visible * size *
        value_noise(x / size, y / size, stream_seed(salt, 7U + static_cast<std::uint64_t>(octave)));
    size *= 0.5;
  }
  return sum;
}

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace gimbal
