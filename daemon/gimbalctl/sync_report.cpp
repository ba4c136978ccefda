#include "daemon/gimbalctl/sync_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

namespace gimbal {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kSigmas95 = 1.96;  // within so many lie 95 % of a normal distribution

double sigma(const JointFit& fit, int index) {
  return std::sqrt(fit.covariance(index, index));
}

/// Of the three components from `first` the least certain.
double worst_sigma(const JointFit& fit, int first) {
  return std::max({sigma(fit, first), sigma(fit, first + 1), sigma(fit, first + 2)});
}

Json interval(double value, double standard_deviation) {
  return {value - kSigmas95 * standard_deviation, value + kSigmas95 * standard_deviation};
}

Json to_json(const Eigen::Matrix3d& matrix) {
  Json rows = Json::array();
  for (Eigen::Index row = 0; row < 3; ++row) {
    rows.push_back({matrix(row, 0), matrix(row, 1), matrix(row, 2)});
  }
  return rows;
}

Json curve_json(const std::vector<OffsetCost>& curve) {
  Json points = Json::array();
  for (const OffsetCost& point : curve) points.push_back({point.offset_s, point.cost_px2});
  return points;
}

/// Keys of the contract come first and are there whatever was found.
Json nothing_known() {
  Json json;
  for (const char* key : {"time_offset_s", "time_offset_sigma_s", "readout_s", "readout_sigma_s",
                          "R_camera_imu", "gyro_bias_rad_s"}) {
    json[key] = nullptr;
  }
  return json;
}

void add_fit(const Synchronization& found, const CameraCalibration& camera, Json& json) {
  const JointFit& fit = *found.fit;
  const JointParameters& at = fit.parameters;
  const double offset_sigma_s = sigma(fit, JointIndex::offset_s);
  const double readout_sigma_s = sigma(fit, JointIndex::readout_s);
  json["time_offset_s"] = at.offset_s;
  json["time_offset_sigma_s"] = offset_sigma_s;
  json["time_offset_interval_s"] = interval(at.offset_s, offset_sigma_s);
  json["readout_s"] = at.readout_s;
  json["readout_sigma_s"] = readout_sigma_s;
  json["readout_interval_s"] = interval(at.readout_s, readout_sigma_s);
  if (!found.is_left_handed) {
    json["R_camera_imu"] = to_json(at.R_camera_imu);
    const Eigen::Vector3d& bias = at.gyro_bias_rad_s;
    json["gyro_bias_rad_s"] = {bias.x(), bias.y(), bias.z()};
  }
  json["R_camera_imu_sigma_rad"] = worst_sigma(fit, JointIndex::axes_rad);
  json["gyro_bias_sigma_rad_s"] = worst_sigma(fit, JointIndex::bias_rad_s);
  json["focal_px"] = {at.focal_scale * camera.lens.K(0, 0), at.focal_scale * camera.lens.K(1, 1)};
  json["focal_sigma_px"] = sigma(fit, JointIndex::log_focal) * at.focal_scale * camera.lens.K(0, 0);
  json["residual_px"] = fit.noise_px;
  json["pairs"] = fit.pairs;
  json["agreeing"] = fit.agreeing;
}

std::string axes_lines(const JointFit& fit) {
  std::string text = "axes          R_camera_imu =";
  for (Eigen::Index row = 0; row < 3; ++row) {
    const auto values = fit.parameters.R_camera_imu.row(row);
    text += fmt::format("{} [{:8.5f}, {:8.5f}, {:8.5f}]\n", row == 0 ? "" : std::string(28, ' '),
                        values[0], values[1], values[2]);
  }
  return text + fmt::format("              ± {:.3f}°\n",
                            2 * kDegrees * worst_sigma(fit, JointIndex::axes_rad));
}

std::string fit_lines(const Synchronization& found, const CameraCalibration& camera) {
  const JointFit& fit = *found.fit;
  const JointParameters& at = fit.parameters;
  std::string text =
      fmt::format("time offset   {:9.3f} ± {:.3f} ms\n", 1e3 * at.offset_s,
                  2e3 * sigma(fit, JointIndex::offset_s)) +
      fmt::format("readout       {:9.3f} ± {:.3f} ms\n", 1e3 * at.readout_s,
                  2e3 * sigma(fit, JointIndex::readout_s)) +
      fmt::format("focal length  {:9.2f} ± {:.2f} px (was {:.2f})\n",
                  at.focal_scale * camera.lens.K(0, 0),
                  2 * sigma(fit, JointIndex::log_focal) * camera.lens.K(0, 0), camera.lens.K(0, 0));
  if (!found.is_left_handed) {
    const Eigen::Vector3d bias = kDegrees * at.gyro_bias_rad_s;
    text += fmt::format("gyro bias     {:9.4f}, {:.4f}, {:.4f} ± {:.4f} °/s\n", bias.x(), bias.y(),
                        bias.z(), 2 * kDegrees * worst_sigma(fit, JointIndex::bias_rad_s));
    text += axes_lines(fit);
  }
  return text + fmt::format("compared      {} pairs of corners, {:.0f} % agree, {:.2f} px apart\n",
                            fit.pairs, 100 * fit.agreeing, fit.noise_px);
}

}  // namespace

std::string describe(const Synchronization& found, const CameraCalibration& camera) {
  std::string text = found.fit ? fit_lines(found, camera) : "";
  if (!found.axes_fault.empty()) {
    text +=
        fmt::format("the gyroscope's axes are not what session.toml says: {}\n", found.axes_fault);
  }
  return text + (found.reason.empty() ? "ok: this can be trusted\n"
                                      : "cannot tell: " + found.reason + "\n");
}

std::string to_json(const Synchronization& found, const CameraCalibration& camera) {
  Json json = nothing_known();
  if (found.fit) add_fit(found, camera, json);
  json["axes_fault"] = found.axes_fault;
  json["verdict"] = found.reason.empty() ? "ok" : "cannot-tell";
  json["reason"] = found.reason;
  json["curve"] = {{"offset_s_and_cost_px2", curve_json(found.curve)}};
  return json.dump(2) + "\n";
}

Plot offset_plot(const Synchronization& found) {
  Plot plot;
  plot.title = "How badly the gyroscope explains the picture";
  plot.x_label = "time offset, ms";
  plot.y_label = "J, px²";
  plot.curves.emplace_back();
  for (const OffsetCost& point : found.curve) {
    plot.curves.back().points.emplace_back(1e3 * point.offset_s, point.cost_px2);
  }
  if (found.fit) plot.marked_x = 1e3 * found.fit->parameters.offset_s;
  return plot;
}

}  // namespace gimbal
