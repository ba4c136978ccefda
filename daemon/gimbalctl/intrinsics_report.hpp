#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/intrinsics/intrinsics.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Names of the fit's values: fx, fy, cx, cy and the distortion's.
[[nodiscard]] std::vector<std::string_view> value_names(LensModel model);

/// The values, in the same order.
[[nodiscard]] std::vector<double> values_of(const LensParameters& lens);

/// For people: several lines, of which the last says whether to trust it.
[[nodiscard]] std::string describe(const Intrinsics& found);

/// For programs.
[[nodiscard]] std::string to_json(const Intrinsics& found);

/// Draws where in the picture corners were seen, and by how much the lens misses them, a hundred
/// times as long. bad_input if the file cannot be written.
[[nodiscard]] Result<void> write_corner_plot(const Intrinsics& found, ImageSize size,
                                             const std::filesystem::path& path);

}  // namespace gimbal
