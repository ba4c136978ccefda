#pragma once

#include <array>
#include <cstdint>

namespace gimbal {

/// How a picture is read between its pixels.
enum class Interpolation : std::uint8_t {
  bilinear,  ///< of 2 x 2 pixels
  bicubic,  ///< of 4 x 4, Catmull-Rom: keeps more of what is fine, and overshoots a little at edges
};

/// Weights that a row or a column of neighbours is summed with.
constexpr int kTapWeightBits = 11;  // 8 bits of picture and two weights of 11 bits fit an int
constexpr int kTapWeightOne = 1 << kTapWeightBits;

/// The two neighbours of a point. `fraction`, of 15 bits, is how far it is past the first.
struct BilinearKernel {
  static constexpr int kTaps = 2;
  static constexpr int kTapsBefore = 0;  ///< taps ahead of the pixel at or before the point

  static constexpr std::array<int, kTaps> weights(int fraction) {
    const int second = fraction >> (15 - kTapWeightBits);
    return {kTapWeightOne - second, second};
  }
};

/// E. Catmull and R. Rom, "A class of local interpolating splines", 1974; also R. Keys, "Cubic
/// convolution interpolation for digital image processing", 1981, with a = -1/2.
struct CatmullRomKernel {
  static constexpr int kTaps = 4;
  static constexpr int kTapsBefore = 1;

  /// With t the fraction and s = 1 - t: the linear weights s and t, plus t s s - t t s / 2 and its
  /// mirror image, less half of each for the outer two.
  static constexpr std::array<int, kTaps> weights(int fraction) {
    constexpr std::int64_t kOne = 1 << 15;
    const std::int64_t t = fraction;
    const std::int64_t s = kOne - t;
    const auto rounded = [](std::int64_t halves) {
      constexpr int kDropped = 46 - kTapWeightBits;
      return static_cast<int>((halves + (std::int64_t{1} << (kDropped - 1))) >> kDropped);
    };
    const int before = rounded(-t * s * s);
    const int after = rounded(-t * t * s);
    const int second = rounded(2 * t * kOne * kOne + 2 * t * t * s - t * s * s);
    return {before, kTapWeightOne - before - second - after, second, after};
  }
};

/// Calls act(kernel).
template <typename Act>
constexpr auto with_kernel(Interpolation interpolation, Act&& act) {
  return interpolation == Interpolation::bicubic ? act(CatmullRomKernel()) : act(BilinearKernel());
}

}  // namespace gimbal
