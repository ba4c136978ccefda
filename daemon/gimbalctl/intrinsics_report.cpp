#include "daemon/gimbalctl/intrinsics_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstddef>
#include <fstream>
#include <nlohmann/json.hpp>

#include "drivers/replay/calibration_keys.hpp"

namespace gimbal {
namespace {

using Json = nlohmann::ordered_json;

Json views_json(const std::vector<ViewError>& errors) {
  Json views = Json::array();
  for (const ViewError& error : errors) {
    views.push_back({{"name", error.name}, {"corners", error.corners}, {"error_px", error.rms_px}});
  }
  return views;
}

Json K_json(const Eigen::Matrix3d& K) {
  Json rows = Json::array();
  for (Eigen::Index row = 0; row < 3; ++row) rows.push_back({K(row, 0), K(row, 1), K(row, 2)});
  return rows;
}

void add_fit(const LensFit& fit, Json& json) {
  json["model"] = name_of(lens_model_names(), fit.lens.model);
  json["K"] = K_json(fit.lens.K);
  json["distortion"] = fit.lens.distortion;
  const auto names = value_names(fit.lens.model);
  for (std::size_t i = 0; i < names.size(); ++i) {
    json["sigmas"][std::string(names[i])] = fit.sigmas[i];  // infinite ones become null
  }
  json["error_px"] = fit.rms_px;
}

std::string fit_lines(const LensFit& fit) {
  const auto names = value_names(fit.lens.model);
  const auto values = values_of(fit.lens);
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool is_pixels = i < 4;
    text += fmt::format("{:<6}{:12.{}f} ± {:.{}f}{}\n", names[i], values[i], is_pixels ? 2 : 5,
                        2 * fit.sigmas[i], is_pixels ? 2 : 5, is_pixels ? " px" : "");
  }
  return text;
}

std::string view_lines(const std::vector<ViewError>& errors, std::string_view note) {
  std::string text;
  for (const ViewError& error : errors) {
    text += fmt::format("  {:6.3f} px  {:3} corners  {}{}\n", error.rms_px, error.corners,
                        error.name, note);
  }
  return text;
}

}  // namespace

std::vector<std::string_view> value_names(LensModel model) {
  std::vector<std::string_view> names = {"fx", "fy", "cx", "cy"};
  if (model == LensModel::brown) names.insert(names.end(), {"k1", "k2", "p1", "p2", "k3"});
  if (model == LensModel::fisheye) names.insert(names.end(), {"k1", "k2", "k3", "k4"});
  return names;
}

std::vector<double> values_of(const LensParameters& lens) {
  std::vector<double> values = {lens.K(0, 0), lens.K(1, 1), lens.K(0, 2), lens.K(1, 2)};
  values.insert(values.end(), lens.distortion.begin(), lens.distortion.end());
  return values;
}

std::string describe(const Intrinsics& found) {
  std::string text;
  if (found.fit) {
    text += fit_lines(*found.fit) + fmt::format(
                                        "pictures, and how far the lens misses the corners "
                                        "({:.3f} px in all):\n",
                                        found.fit->rms_px);
    text += view_lines(found.errors, "") + view_lines(found.left_out, "  left out");
  }
  text += fmt::format("corners in {:.0f} % of the picture\n", 100 * found.coverage.share());
  if (const auto missing = found.coverage.missing(); !missing.empty()) {
    text += fmt::format("not shown: {}\n", fmt::join(missing, ", "));
  }
  return text + (found.reason.empty() ? "ok: this can be trusted\n"
                                      : "cannot tell: " + found.reason + "\n");
}

std::string to_json(const Intrinsics& found) {
  Json json{{"model", nullptr}, {"K", nullptr}, {"distortion", nullptr}};
  if (found.fit) add_fit(*found.fit, json);
  json["views"] = views_json(found.errors);
  json["left_out"] = views_json(found.left_out);
  json["coverage"] = found.coverage.share();
  json["missing"] = found.coverage.missing();
  json["verdict"] = found.reason.empty() ? "ok" : "cannot-tell";
  json["reason"] = found.reason;
  return json.dump(2) + "\n";
}

Result<void> write_corner_plot(const Intrinsics& found, ImageSize size,
                               const std::filesystem::path& path) {
  constexpr double kTimes = 100;
  std::ofstream file(path);
  if (!file) return bad_input(path.string() + ": cannot be written (does the folder exist?)");
  // A pixel of the picture is a unit of the drawing, so the lines' widths go with the picture's.
  const double unit = size.width / 800.0;
  file << fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"800\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" font-size=\"{2:g}\">\n<rect width=\"100%\" height=\"100%\" "
      "fill=\"white\" stroke=\"#888\"/>\n<text x=\"{2:g}\" y=\"{3:g}\">The board's corners in the "
      "picture, and the errors {4:g} times as long</text>\n",
      size.width, size.height, 13 * unit, 18 * unit, kTimes);
  for (std::size_t view = 0; found.fit && view < found.views.size(); ++view) {
    for (std::size_t i = 0; i < found.views[view].seen_px.size(); ++i) {
      const Eigen::Vector2d& seen = found.views[view].seen_px[i];
      const Eigen::Vector2d end = seen + kTimes * found.fit->residuals_px[view][i];
      file << fmt::format(
          "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"{4:.1f}\" fill=\"#06c\"/><line x1=\"{0:.1f}\" "
          "y1=\"{1:.1f}\" x2=\"{2:.1f}\" y2=\"{3:.1f}\" stroke=\"#c60\" "
          "stroke-width=\"{4:.1f}\"/>\n",
          seen.x(), seen.y(), end.x(), end.y(), unit);
    }
  }
  file << "</svg>\n" << std::flush;
  if (!file) return failed(path.string() + ": the plot could not be written");
  return {};
}

}  // namespace gimbal
