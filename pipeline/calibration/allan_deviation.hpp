#pragma once

#include <span>
#include <vector>

namespace gimbal {

/// One point of an Allan deviation.
struct AllanPoint {
  double tau_s = 0;
  double deviation = 0;    ///< in the values' unit
  double independent = 0;  ///< about how many independent differences it is of
};

/// The overlapping Allan deviation of evenly spaced values (IEEE Std 952-1997, annex C): how much
/// the means over neighbouring stretches of length tau differ, over the square root of 2. Ten taus
/// a decade, from one interval to a quarter of the record.
[[nodiscard]] std::vector<AllanPoint> allan_deviation(std::span<const double> values,
                                                      double interval_s);

}  // namespace gimbal
