#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/sample/result.hpp"

namespace gimbal {

enum class PlotAxes : std::uint8_t { linear, logarithmic };

struct PlotCurve {
  std::string name;                               ///< empty: not told
  std::vector<std::pair<double, double>> points;  ///< x rises; above zero over logarithmic axes
};

/// Curves over a pair of axes. Linear ones hold zero on y.
struct Plot {
  std::string title;
  std::string x_label;
  std::string y_label;
  PlotAxes axes = PlotAxes::linear;
  std::vector<PlotCurve> curves;
  std::optional<double> marked_x;  ///< a line down the plot
};

/// Writes an SVG that a browser shows; bad_input if the file cannot be written.
[[nodiscard]] Result<void> write_svg(const Plot& plot, const std::filesystem::path& path);

}  // namespace gimbal
