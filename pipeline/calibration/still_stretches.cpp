#include "pipeline/calibration/still_stretches.hpp"

#include <algorithm>

namespace gimbal {
namespace {

constexpr SensorDuration kBlock = std::chrono::milliseconds(100);
constexpr SensorDuration kShortest = std::chrono::milliseconds(500);

Eigen::Vector3d median_rate(std::span<const GyroSample> samples) {
  Eigen::Vector3d median;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(samples.size());
    for (const GyroSample& sample : samples) values.push_back(sample.gyro_rad_s[axis]);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[axis] = *middle;
  }
  return median;
}

/// Tenths of a second.
std::vector<Stretch> blocks_of(std::span<const GyroSample> samples) {
  std::vector<Stretch> blocks;
  for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
    while (end < samples.size() && samples[end].time - samples[begin].time < kBlock) ++end;
    blocks.push_back({begin, end});
  }
  return blocks;
}

Eigen::Vector3d mean_rate(std::span<const GyroSample> samples) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const GyroSample& sample : samples) sum += sample.gyro_rad_s;
  return sum / static_cast<double>(samples.size());
}

}  // namespace

std::vector<Stretch> still_stretches(std::span<const GyroSample> samples, double most_rate_rad_s) {
  if (samples.empty()) return {};
  const Eigen::Vector3d rest = median_rate(samples);
  std::vector<Stretch> stretches;
  bool was_still = false;
  for (const Stretch& block : blocks_of(samples)) {
    const auto of_block = samples.subspan(block.begin, block.end - block.begin);
    const bool is_still = (mean_rate(of_block) - rest).cwiseAbs().maxCoeff() < most_rate_rad_s;
    if (is_still && was_still) {
      stretches.back().end = block.end;
    } else if (is_still) {
      stretches.push_back(block);
    }
    was_still = is_still;
  }
  std::erase_if(stretches, [&](const Stretch& stretch) {
    return samples[stretch.end - 1].time - samples[stretch.begin].time < kShortest;
  });
  return stretches;
}

}  // namespace gimbal
