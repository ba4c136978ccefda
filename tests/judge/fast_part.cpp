#include "tests/judge/fast_part.hpp"

#include <cmath>
#include <numbers>

namespace gimbal::judge {

std::vector<cv::Vec3d> fast_part(const std::vector<Measured>& series, double cutoff_hz) {
  std::vector<cv::Vec3d> fast;
  std::size_t first = 0;
  for (const Measured& center : series) {
    const auto reaches = [&](const Measured& m) {
      return std::abs(m.time_s - center.time_s) * cutoff_hz < 1;
    };
    while (!reaches(series[first])) ++first;
    cv::Vec3d sum;
    double weights = 0;
    for (std::size_t i = first; i < series.size() && reaches(series[i]); ++i) {
      const double share = (series[i].time_s - center.time_s) * cutoff_hz;
      const double weight = 0.5 * (1 + std::cos(std::numbers::pi * share));
      sum += weight * series[i].value;
      weights += weight;
    }
    fast.push_back(center.value - sum / weights);
  }
  return fast;
}

double rms_length(const std::vector<cv::Vec3d>& vectors) {
  if (vectors.empty()) return 0;
  double squares = 0;
  for (const cv::Vec3d& vector : vectors) squares += vector.dot(vector);
  return std::sqrt(squares / static_cast<double>(vectors.size()));
}

}  // namespace gimbal::judge
