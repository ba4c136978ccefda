#pragma once

#include <optional>
#include <string_view>

namespace gimbal {

/// The lowest offer at or above the wish, else the highest, in hertz. `available` as IIO prints it:
/// "25 50 100.5", or "[least step most]". Nothing if it offers none.
[[nodiscard]] std::optional<double> nearest_frequency(std::string_view available, double wish_hz);

/// The highest that is offered, in hertz.
[[nodiscard]] std::optional<double> highest_frequency(std::string_view available);

}  // namespace gimbal
