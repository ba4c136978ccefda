#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/sample/result.hpp"

namespace gimbal {

/// One curve over linear axes.
struct Plot {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<std::pair<double, double>> points;  ///< x rises
  double marked_x = 0;                            ///< a line down the plot
};

/// Writes an SVG that a browser shows; bad_input if the file cannot be written.
[[nodiscard]] Result<void> write_svg(const Plot& plot, const std::filesystem::path& path);

}  // namespace gimbal
