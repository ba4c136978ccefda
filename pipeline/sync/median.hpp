#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace gimbal {

/// The upper one of the two in the middle where there is no middle. Precondition: there is one.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The standard deviation of one coordinate that half of the distances in the plane show, if they
/// are those of a normal distribution: their median is sqrt(2 ln 2) of it.
inline double coordinate_sigma(std::vector<double> distances) {
  return median(std::move(distances)) / std::sqrt(2 * std::log(2.0));
}

}  // namespace gimbal
