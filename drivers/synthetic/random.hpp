#pragma once

#include <cstdint>
#include <random>

namespace gimbal {

/// Seeded random numbers that are the same with every standard library: the engine is laid down by
/// the standard, the distributions of <random> are not, so they are written out here.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// In [0, 1).
  double uniform();

  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Mean 0, standard deviation 1 (Box-Muller).
  double normal();

 private:
  std::mt19937_64 engine_;
};

/// A seed for one of several streams that share the user's seed (SplitMix64's finaliser, Steele et
/// al. 2014), so that asking for one more sample here leaves the numbers there as they were.
constexpr std::uint64_t stream_seed(std::uint64_t seed, std::uint64_t stream) {
  std::uint64_t z = seed + (stream + 1) * 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31U);
}

}  // namespace gimbal
