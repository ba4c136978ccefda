#include <fmt/core.h>
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>

#include "daemon/gimbalctl/calibration_profile.hpp"
#include "daemon/gimbalctl/calibrations.hpp"
#include "daemon/gimbalctl/svg_plot.hpp"
#include "daemon/gimbalctl/warnings.hpp"
#include "drivers/replay/session.hpp"
#include "pipeline/calibration/accel_faces.hpp"
#include "pipeline/calibration/gyro_noise.hpp"

namespace gimbal {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180 / std::numbers::pi;

struct Arguments {
  std::filesystem::path still;
  std::filesystem::path faces;  ///< empty: none
  ResultFiles files;
  bool json = false;
};

struct Findings {
  GyroNoise gyro;
  std::optional<AccelErrors> accel;

  [[nodiscard]] std::string reason() const {
    if (!gyro.reason.empty()) return "gyroscope: " + gyro.reason;
    return accel && !accel->reason.empty() ? "accelerometer: " + accel->reason : "";
  }
};

Json to_json(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

std::string to_json(const Findings& found) {
  Json json{{"gyro_bias_rad_s", nullptr}};
  if (found.gyro.reason.empty()) {
    json = {{"still_s", found.gyro.still_s},
            {"gyro_bias_rad_s", to_json(found.gyro.bias_rad_s)},
            {"gyro_bias_sigma_rad_s", to_json(found.gyro.bias_sigma_rad_s)},
            {"gyro_noise_rad_s_rthz", to_json(found.gyro.noise_rad_s_rthz)},
            {"gyro_bias_instability_rad_s", to_json(found.gyro.instability_rad_s)},
            {"gyro_bias_walk_at_most_rad_s_rts", to_json(found.gyro.most_bias_walk)}};
  }
  if (found.accel && found.accel->reason.empty()) {
    json["accel_scale"] = to_json(found.accel->scale);
    json["accel_bias_m_s2"] = to_json(found.accel->bias_m_s2);
    json["accel_poses"] = found.accel->poses;
    json["accel_residual_m_s2"] = found.accel->residual_m_s2;
  }
  json["verdict"] = found.reason().empty() ? "ok" : "cannot-tell";
  json["reason"] = found.reason();
  return json.dump(2) + "\n";
}

std::string row(const char* name, const Eigen::Vector3d& values, const char* unit) {
  return fmt::format("{:<28}{:12.6g}{:12.6g}{:12.6g}  {}\n", name, values.x(), values.y(),
                     values.z(), unit);
}

std::string heading() {
  return fmt::format("{:<28}{:>12}{:>12}{:>12}\n", "", "x", "y", "z");
}

std::string describe(const Findings& found) {
  std::string text;
  if (found.gyro.reason.empty()) {
    const GyroNoise& gyro = found.gyro;
    text += heading() + row("gyro bias", gyro.bias_rad_s, "rad/s") +
            row("  in degrees", kDegrees * gyro.bias_rad_s, "°/s") +
            row("  known to (1 sigma)", gyro.bias_sigma_rad_s, "rad/s") +
            row("gyro white noise", gyro.noise_rad_s_rthz, "rad/s/√Hz") +
            row("gyro bias instability", gyro.instability_rad_s, "rad/s, at most") +
            row("gyro bias walk", gyro.most_bias_walk, "rad/s/√s, at most") +
            fmt::format("from {:.1f} s without a move\n", gyro.still_s);
  }
  if (found.accel && found.accel->reason.empty()) {
    const AccelErrors& accel = *found.accel;
    text +=
        heading() + row("accelerometer scale", accel.scale, "") +
        row("accelerometer bias", accel.bias_m_s2, "m/s²") +
        fmt::format("from {} poses, {:.3f} m/s² from gravity\n", accel.poses, accel.residual_m_s2);
  }
  return text + (found.reason().empty() ? "ok: this can be trusted\n"
                                        : "cannot tell: " + found.reason() + "\n");
}

Plot allan_plot(const GyroNoise& noise) {
  Plot plot;
  plot.title = "Allan deviation of the gyroscope";
  plot.x_label = "tau, s";
  plot.y_label = "rad/s";
  plot.axes = PlotAxes::logarithmic;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    plot.curves.push_back({std::string(1, "xyz"[axis]), {}});
    for (const AllanPoint& point : noise.allan.at(axis)) {
      if (point.deviation > 0) {
        plot.curves.back().points.emplace_back(point.tau_s, point.deviation);
      }
    }
  }
  return plot;
}

Result<Session> open(const std::filesystem::path& path) {
  Result<Session> session = open_session(path);
  if (!session) return session;
  print_warnings(session->warnings);
  if (session->gyro.empty()) return bad_input(path.string() + ": there are no gyroscope samples");
  return session;
}

Result<Findings> measure(const Arguments& arguments) {
  const auto still = open(arguments.still);
  if (!still) return tl::unexpected(still.error());
  Findings found{measure_gyro_noise(still->gyro), std::nullopt};
  if (arguments.faces.empty()) return found;
  const auto faces = open(arguments.faces);
  if (!faces) return tl::unexpected(faces.error());
  if (faces->accel.empty()) {
    return bad_input(arguments.faces.string() + ": there are no accelerometer samples");
  }
  found.accel = fit_accel_errors(faces->accel, faces->gyro);
  return found;
}

Result<void> run(const Arguments& arguments) {
  if (auto can_write = check_files(arguments.files); !can_write) return can_write;
  const auto found = measure(arguments);
  if (!found) return tl::unexpected(found.error());
  fmt::print("{}", arguments.json ? to_json(*found) : describe(*found));
  if (!arguments.files.plot.empty() && found->gyro.reason.empty()) {
    const auto written = write_svg(allan_plot(found->gyro), arguments.files.plot);
    if (!written) return written;
  }
  if (found->reason().empty()) return {};
  return bad_input("cannot tell: " + found->reason());
}

}  // namespace

void add_calibrate_imu(CLI::App& calibrate, CommandOutcome& outcome) {
  CLI::App* const command = calibrate.add_subcommand(
      "imu", "Gyro bias and noise from a still minute, accelerometer errors from six faces");
  const auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("session", arguments->still,
                   "Session folder, camera not needed: a minute in which the device lies still")
      ->required();
  command->add_option("--faces", arguments->faces,
                      "SESSION in which it was laid on each of its six faces for two seconds");
  add_plot_option(*command, arguments->files, "FILE.svg: the gyroscope's Allan deviation");
  add_overwrite_flag(*command, arguments->files);
  command->add_flag("--json", arguments->json, "For programs");
  command->callback([arguments, &outcome] { outcome = run(*arguments); });
}

}  // namespace gimbal
