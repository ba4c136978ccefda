#include "drivers/synthetic/random.hpp"

#include <cmath>
#include <numbers>

namespace gimbal {

double Random::uniform() {
  constexpr double kUnitsPerOne = 9007199254740992.0;  // 2^53: all that a double's mantissa holds
  return static_cast<double>(engine_() >> 11U) / kUnitsPerOne;
}

double Random::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

}  // namespace gimbal
