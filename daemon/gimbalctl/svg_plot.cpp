#include "daemon/gimbalctl/svg_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace gimbal {
namespace {

constexpr double kWidth = 800;
constexpr double kHeight = 450;
constexpr double kLeft = 70;
constexpr double kRight = 20;
constexpr double kTop = 40;
constexpr double kBottom = 55;

/// From values to places on the picture.
struct Scale {
  double low;
  double high;
  double place_of_low;
  double place_of_high;

  [[nodiscard]] double operator()(double value) const {
    return place_of_low + (value - low) / (high - low) * (place_of_high - place_of_low);
  }
};

/// 1, 2 or 5 times a power of ten, so that about six lie in the range.
double tick_step(const Scale& scale) {
  const double wanted = (scale.high - scale.low) / 6;
  const double power = std::pow(10, std::floor(std::log10(wanted)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= wanted) return factor * power;
  }
  return 10 * power;
}

std::vector<double> ticks(const Scale& scale) {
  const double step = tick_step(scale);
  std::vector<double> values;
  for (double n = std::ceil(scale.low / step); n * step <= scale.high; ++n) {
    values.push_back(n * step);
  }
  return values;
}

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor,
                     text);
}

std::string line(double x1, double y1, double x2, double y2, const char* color) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x1, y1, x2,
      y2, color);
}

std::string axes(const Plot& plot, const Scale& x, const Scale& y) {
  std::string svg;
  for (const double value : ticks(x)) {
    svg += line(x(value), kTop, x(value), kHeight - kBottom, "#ddd");
    svg += text_at(x(value), kHeight - kBottom + 18, "middle", fmt::format("{:.6g}", value));
  }
  for (const double value : ticks(y)) {
    svg += line(kLeft, y(value), kWidth - kRight, y(value), "#ddd");
    svg += text_at(kLeft - 6, y(value) + 4, "end", fmt::format("{:.6g}", value));
  }
  svg += text_at((kLeft + kWidth - kRight) / 2, kHeight - 12, "middle", plot.x_label);
  svg += text_at(kLeft, kTop - 10, "end", plot.y_label);
  return svg + text_at((kLeft + kWidth - kRight) / 2, kTop - 14, "middle", plot.title);
}

std::string curve(const Plot& plot, const Scale& x, const Scale& y) {
  std::string svg = "<polyline fill=\"none\" stroke=\"#06c\" stroke-width=\"1.5\" points=\"";
  for (const auto& [point_x, point_y] : plot.points) {
    svg += fmt::format("{:.1f},{:.1f} ", x(point_x), y(point_y));
  }
  return svg + "\"/>\n";
}

std::string draw(const Plot& plot) {
  const auto [least, most] =
      std::minmax_element(plot.points.begin(), plot.points.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; });
  const Scale x{plot.points.front().first, plot.points.back().first, kLeft, kWidth - kRight};
  const Scale y{std::min(0.0, least->second), std::max(most->second, 1e-9) * 1.05,
                kHeight - kBottom, kTop};
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 "
      "{0:g} {1:g}\" font-family=\"sans-serif\" font-size=\"13\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      kWidth, kHeight);
  svg += axes(plot, x, y);
  svg += line(x(plot.marked_x), kTop, x(plot.marked_x), kHeight - kBottom, "#c00");
  return svg + curve(plot, x, y) + "</svg>\n";
}

}  // namespace

Result<void> write_svg(const Plot& plot, const std::filesystem::path& path) {
  if (plot.points.size() < 2) return bad_input(path.string() + ": there is no curve to plot");
  std::ofstream file(path);
  if (!file) return bad_input(path.string() + ": cannot be written (does the folder exist?)");
  file << draw(plot) << std::flush;
  if (!file) return failed(path.string() + ": the plot could not be written");
  return {};
}

}  // namespace gimbal
