#include "pipeline/calibration/allan_deviation.hpp"

#include <cmath>
#include <cstddef>

namespace gimbal {
namespace {

constexpr double kTausPerDecade = 10;

/// Sums of the first n values, n = 0, 1...
std::vector<double> running_sums(std::span<const double> values) {
  std::vector<double> sums = {0};
  sums.reserve(values.size() + 1);
  for (const double value : values) sums.push_back(sums.back() + value);
  return sums;
}

AllanPoint point_at(const std::vector<double>& sums, std::size_t length, double interval_s) {
  const std::size_t count = sums.size() - 2 * length;
  double total = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double difference = sums[k + 2 * length] - 2 * sums[k + length] + sums[k];
    total += difference * difference;
  }
  const auto samples = static_cast<double>(length);
  const double variance = total / (2 * samples * samples * static_cast<double>(count));
  return {samples * interval_s, std::sqrt(variance), static_cast<double>(sums.size()) / samples};
}

}  // namespace

std::vector<AllanPoint> allan_deviation(std::span<const double> values, double interval_s) {
  const std::vector<double> sums = running_sums(values);
  std::vector<AllanPoint> points;
  std::size_t length = 1;
  for (int step = 0; length * 4 <= values.size(); ++step) {
    const auto next = static_cast<std::size_t>(std::lround(std::pow(10, step / kTausPerDecade)));
    if (next > length || step == 0) {
      length = next;
      if (length * 4 <= values.size()) points.push_back(point_at(sums, length, interval_s));
    }
  }
  return points;
}

}  // namespace gimbal
