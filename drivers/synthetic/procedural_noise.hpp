#pragma once

#include <cstdint>

namespace gimbal {

/// A number in [0, 1) that belongs to a pair of whole numbers and a salt; neighbours have nothing
/// in common.
[[nodiscard]] double lattice_random(std::int64_t x, std::int64_t y, std::uint64_t salt);

/// Smooth noise in [-1, 1] with features of size 1 (value noise: a random number at each lattice
/// point, blended by a quintic).
[[nodiscard]] double value_noise(double x, double y, std::uint64_t salt);

/// Sum of `octaves` of value noise, each half as large and half as high as the one before; octaves
/// finer than `footprint` (what one sample covers, in units of x) are faded out, for they would
/// alias.
[[nodiscard]] double fractal_noise(double x, double y, int octaves, double footprint,
                                   std::uint64_t salt);

/// Cubic step from 0 at `low` to 1 at `high`.
[[nodiscard]] double smooth_step(double low, double high, double x);

}  // namespace gimbal
