#include "pipeline/calibration/gyro_noise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/calibration/still_stretches.hpp"

namespace gimbal {
namespace {

constexpr double kShortest_s = 30;
constexpr double kMostRate_rad_s = 0.5 * std::numbers::pi / 180;
// Between what low-pass filters take away and what drifts bring in.
constexpr double kWhiteFrom_s = 0.05;
constexpr double kWhiteTo_s = 1;
constexpr double kFlickerFactor = 0.664;  // sqrt(2 ln 2 / pi): IEEE Std 952-1997, C.1.3
constexpr double kFewestIndependent = 8;  // of a point that says anything about drifts

/// Slope -1/2: deviation² tau is N². Each point counts by how many differences it is of.
double white_noise(const std::vector<AllanPoint>& points) {
  double sum = 0;
  double weights = 0;
  for (const AllanPoint& point : points) {
    if (point.tau_s < kWhiteFrom_s || point.tau_s > kWhiteTo_s) continue;
    sum += point.independent * point.deviation * point.deviation * point.tau_s;
    weights += point.independent;
  }
  return std::sqrt(sum / weights);
}

/// The least of a function of the points that are well enough known.
template <typename Function>
double least_of(const std::vector<AllanPoint>& points, Function function) {
  double least = std::numeric_limits<double>::infinity();
  for (const AllanPoint& point : points) {
    if (point.independent >= kFewestIndependent) least = std::min(least, function(point));
  }
  return least;
}

void measure_axis(std::span<const GyroSample> samples, Eigen::Index axis, GyroNoise& noise) {
  std::vector<double> values;
  values.reserve(samples.size());
  double sum = 0;
  for (const GyroSample& sample : samples) {
    values.push_back(sample.gyro_rad_s[axis]);
    sum += sample.gyro_rad_s[axis];
  }
  const auto points = allan_deviation(values, noise.interval_s);
  const double lowest = least_of(points, [](const AllanPoint& p) { return p.deviation; });
  noise.bias_rad_s[axis] = sum / static_cast<double>(values.size());
  noise.noise_rad_s_rthz[axis] = white_noise(points);
  noise.instability_rad_s[axis] = lowest / kFlickerFactor;
  noise.most_bias_walk[axis] =
      least_of(points, [](const AllanPoint& p) { return p.deviation * std::sqrt(3 / p.tau_s); });
  noise.bias_sigma_rad_s[axis] = noise.noise_rad_s_rthz[axis] / std::sqrt(noise.still_s);
  noise.allan.at(static_cast<std::size_t>(axis)) = points;
}

}  // namespace

GyroNoise measure_gyro_noise(std::span<const GyroSample> samples) {
  GyroNoise noise;
  const auto stretches = still_stretches(samples, kMostRate_rad_s);
  const auto seconds = [&](const Stretch& stretch) {
    return to_seconds(samples[stretch.end - 1].time - samples[stretch.begin].time);
  };
  const auto longest =
      std::max_element(stretches.begin(), stretches.end(),
                       [&](const Stretch& a, const Stretch& b) { return seconds(a) < seconds(b); });
  if (longest != stretches.end()) noise.still_s = seconds(*longest);
  if (noise.still_s < kShortest_s) {
    noise.reason = fmt::format(
        "it lies still for {:.1f} s at most; {:.0f} s are needed, and a "
        "minute is better",
        noise.still_s, kShortest_s);
    return noise;
  }
  const std::size_t count = longest->end - longest->begin;
  noise.interval_s = noise.still_s / static_cast<double>(count - 1);
  if (noise.interval_s > kWhiteTo_s / 4) {
    noise.reason = fmt::format("{:.1f} samples a second are too few", 1 / noise.interval_s);
    return noise;
  }
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    measure_axis(samples.subspan(longest->begin, count), axis, noise);
  }
  return noise;
}

}  // namespace gimbal
