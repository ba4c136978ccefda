#include "daemon/gimbalctl/svg_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>

namespace gimbal {
namespace {

constexpr double kWidth = 800;
constexpr double kHeight = 450;
constexpr double kLeft = 70;
constexpr double kRight = 20;
constexpr double kTop = 40;
constexpr double kBottom = 55;

constexpr std::array<const char*, 4> kColors = {"#06c", "#c60", "#083", "#808"};

/// From values to places on the picture.
struct Scale {
  PlotAxes axes;
  double low;
  double high;
  double place_of_low;
  double place_of_high;

  [[nodiscard]] double operator()(double value) const {
    const auto along = [&](double v) { return axes == PlotAxes::linear ? v : std::log(v); };
    const double share = (along(value) - along(low)) / (along(high) - along(low));
    return place_of_low + share * (place_of_high - place_of_low);
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

std::vector<double> linear_ticks(const Scale& scale) {
  const double step = tick_step(scale);
  std::vector<double> values;
  for (auto n = std::lround(std::ceil(scale.low / step));
       static_cast<double>(n) * step <= scale.high; ++n) {
    values.push_back(static_cast<double>(n) * step);
  }
  return values;
}

std::vector<double> logarithmic_ticks(const Scale& scale) {
  std::vector<double> values;
  const auto last = std::lround(std::floor(std::log10(scale.high)));
  for (auto power = std::lround(std::floor(std::log10(scale.low))); power <= last; ++power) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double value = factor * std::pow(10, power);
      if (value >= scale.low && value <= scale.high) values.push_back(value);
    }
  }
  return values;
}

std::vector<double> ticks(const Scale& scale) {
  return scale.axes == PlotAxes::linear ? linear_ticks(scale) : logarithmic_ticks(scale);
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

std::string curve(const PlotCurve& drawn, const char* color, const Scale& x, const Scale& y) {
  std::string svg =
      fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\" points=\"", color);
  for (const auto& [point_x, point_y] : drawn.points) {
    svg += fmt::format("{:.1f},{:.1f} ", x(point_x), y(point_y));
  }
  return svg + "\"/>\n";
}

std::string legend(const PlotCurve& drawn, const char* color, std::size_t place) {
  const double top = kTop + 18 + 18 * static_cast<double>(place);
  return line(kWidth - kRight - 60, top - 4, kWidth - kRight - 36, top - 4, color) +
         text_at(kWidth - kRight - 30, top, "start", drawn.name);
}

/// The points' bounding box.
struct Range {
  double left = std::numeric_limits<double>::infinity();
  double right = -left;
  double bottom = left;
  double top = -left;

  explicit Range(const std::vector<PlotCurve>& curves) {
    for (const PlotCurve& drawn : curves) {
      for (const auto& [x, y] : drawn.points) {
        left = std::min(left, x);
        right = std::max(right, x);
        bottom = std::min(bottom, y);
        top = std::max(top, y);
      }
    }
  }
};

std::string draw(const Plot& plot, const Range& range) {
  const double bottom =
      plot.axes == PlotAxes::linear ? std::min(0.0, range.bottom) : range.bottom / 1.2;
  const double top = std::max(range.top * 1.05, bottom + 1e-9);
  const Scale x{plot.axes, range.left, range.right, kLeft, kWidth - kRight};
  const Scale y{plot.axes, bottom, top, kHeight - kBottom, kTop};
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 "
      "{0:g} {1:g}\" font-family=\"sans-serif\" font-size=\"13\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      kWidth, kHeight);
  svg += axes(plot, x, y);
  if (plot.marked_x) {
    svg += line(x(*plot.marked_x), kTop, x(*plot.marked_x), kHeight - kBottom, "#c00");
  }
  for (std::size_t i = 0; i < plot.curves.size(); ++i) {
    const char* const color = kColors.at(i % kColors.size());
    svg += curve(plot.curves[i], color, x, y);
    if (!plot.curves[i].name.empty()) svg += legend(plot.curves[i], color, i);
  }
  return svg + "</svg>\n";
}

}  // namespace

Result<void> write_svg(const Plot& plot, const std::filesystem::path& path) {
  const Range range(plot.curves);
  if (!(range.right > range.left)) return bad_input(path.string() + ": there is nothing to plot");
  std::ofstream file(path);
  if (!file) return bad_input(path.string() + ": cannot be written (does the folder exist?)");
  file << draw(plot, range) << std::flush;
  if (!file) return failed(path.string() + ": the plot could not be written");
  return {};
}

}  // namespace gimbal
