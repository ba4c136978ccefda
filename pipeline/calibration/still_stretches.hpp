#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {

/// Samples [begin, end) of a log.
struct Stretch {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Where the device lies still for half a second at least: the rate stays within
/// `most_rate_rad_s` of the log's median, an axis each, as a mean over tenths of a second.
[[nodiscard]] std::vector<Stretch> still_stretches(std::span<const GyroSample> samples,
                                                   double most_rate_rad_s);

}  // namespace gimbal
