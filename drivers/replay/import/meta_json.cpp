#include <fmt/core.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "drivers/replay/import/importer.hpp"
#include "drivers/replay/session_logs.hpp"
#include "drivers/replay/stamped_log.hpp"

namespace gimbal {

namespace {

using Json = nlohmann::json;

/// ARKit's camera axes are x right, y up, z back.
Eigen::Matrix3d R_camera_arkit() {
  return Eigen::Vector3d(1, -1, -1).asDiagonal();
}

std::optional<Json> load(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return std::nullopt;
  std::ifstream file(path);
  Json json = Json::parse(file, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  return json;
}

/// The description of one recording, with faults that name file and key.
class MetaJson {
 public:
  MetaJson(std::filesystem::path path, Json json)
      : path_(std::move(path)), json_(std::move(json)) {}

  [[nodiscard]] bool has(const char* key) const {
    return json_.contains(key) && !json_.at(key).is_null();
  }

  [[nodiscard]] std::string text(const char* key) const {
    return has(key) && json_.at(key).is_string() ? json_.at(key).get<std::string>() : "";
  }

  [[nodiscard]] Result<double> number(const char* key) const {
    if (has(key) && json_.at(key).is_number()) return json_.at(key).get<double>();
    return fault(key, "a number");
  }

  [[nodiscard]] Result<Eigen::Matrix3d> matrix3(const char* key) const {
    Eigen::Matrix3d matrix;
    const Json rows = json_.value(key, Json());
    if (!rows.is_array() || rows.size() != 3) return fault(key, "three rows of three numbers");
    for (std::size_t r = 0; r < 3; ++r) {
      if (!rows[r].is_array() || rows[r].size() != 3)
        return fault(key, "three rows of three numbers");
      for (std::size_t c = 0; c < 3; ++c) {
        if (!rows[r][c].is_number()) return fault(key, "three rows of three numbers");
        matrix(static_cast<int>(r), static_cast<int>(c)) = rows[r][c].get<double>();
      }
    }
    return matrix;
  }

 private:
  [[nodiscard]] tl::unexpected<Error> fault(const char* key, std::string_view expected) const {
    return bad_input(
        fmt::format("{}: {} is missing or wrong; {} is expected", path_.string(), key, expected));
  }

  std::filesystem::path path_;
  Json json_;
};

constexpr const char* kCameraAxes = "w_cam_from_gyro";
constexpr const char* kArkitAxes = "w_ARKitcam_from_gyro";

Result<Eigen::Matrix3d> read_R_camera_imu(const MetaJson& meta) {
  if (meta.has(kCameraAxes)) return meta.matrix3(kCameraAxes);
  return meta.matrix3(kArkitAxes).map([](const Eigen::Matrix3d& R_arkit_imu) -> Eigen::Matrix3d {
    return R_camera_arkit() * R_arkit_imu;
  });
}

/// The fitted times are used where there are any: they say when a row's exposure was in its middle,
/// so the exposure is in the offset already and must not be subtracted again.
Result<CameraCalibration> read_camera(const MetaJson& meta, Session& session) {
  const Result<Eigen::Matrix3d> K = meta.matrix3("K");
  const Result<double> width = meta.number("width");
  const Result<double> height = meta.number("height");
  const Result<double> readout_s = meta.number("readout_s_fitted");
  const Result<double> offset_s = meta.number("td_s_fitted");
  if (!K) return tl::unexpected(K.error());
  for (const Result<double>* number : {&width, &height, &readout_s, &offset_s}) {
    if (!*number) return tl::unexpected(number->error());
  }
  constexpr double kLargestSide_px = 65535;
  if (!(*width >= 1 && *width <= kLargestSide_px && *height >= 1 && *height <= kLargestSide_px) ||
      !(std::abs(*readout_s) < 10) || !(std::abs(*offset_s) < 1e9)) {
    return bad_input("meta.json: width, height, readout_s_fitted or td_s_fitted is out of range");
  }
  CameraCalibration camera;
  camera.size = {static_cast<int>(*width), static_cast<int>(*height)};
  camera.lens.K = *K;
  camera.readout = duration_from_seconds(*readout_s);
  camera.time_offset = duration_from_seconds(*offset_s);
  session.notes.emplace_back(
      "readout_s and time_offset_s are fitted to the picture: row y of H is exposed, in the "
      "middle, "
      "at t_s + time_offset_s + readout_s*y/H.");
  if (meta.has("exposure_s")) {
    session.notes.push_back(fmt::format(
        "The exposure of {} s is part of that time_offset_s, so frames.csv has no exposure_s.",
        meta.number("exposure_s").value_or(0)));
  }
  return camera;
}

/// 1 or -1: whether the recording's accelerometer has the sign of specific force or of gravity.
double accel_sign(const MetaJson& meta) {
  return meta.text("units").find("CoreMotion") != std::string::npos ? -1.0 : 1.0;
}

double fps_of(const std::vector<FrameStamp>& frames) {
  const double step_s = to_seconds(median_step(frames));
  return step_s > 0 ? 1.0 / step_s : 0.0;
}

Result<void> read_logs(const std::filesystem::path& folder, const MetaJson& meta,
                       Session& session) {
  Result<SessionLogs> logs = read_session_logs(folder, accel_sign(meta), session.warnings);
  if (!logs) return tl::unexpected(logs.error());
  session.gyro = std::move(logs->gyro.samples);
  session.accel = std::move(logs->accel.samples);
  session.frames = std::move(logs->frames.samples);
  return {};
}

Result<Session> read_meta_json(const std::filesystem::path& input) {
  const std::filesystem::path path = input / "meta.json";
  std::optional<Json> json = load(path);
  if (!json) return bad_input(fmt::format("{}: not a JSON object", path.string()));
  const MetaJson meta(path, std::move(*json));
  Session session;
  session.video = find_session_video(input, session.warnings);
  for (const char* key : {"source", "licence"}) {
    if (meta.has(key)) session.notes.push_back(fmt::format("{}: {}", key, meta.text(key)));
  }
  const Result<Eigen::Matrix3d> R_camera_imu = read_R_camera_imu(meta);
  if (!R_camera_imu) return tl::unexpected(R_camera_imu.error());
  session.imu.R_camera_imu = *R_camera_imu;
  session.device = meta.has(kArkitAxes) ? "iPhone" : "phone";
  if (Result<void> read = read_logs(input, meta, session); !read)
    return tl::unexpected(read.error());
  if (!meta.has("K")) return session;
  Result<CameraCalibration> camera = read_camera(meta, session);
  if (!camera) return tl::unexpected(camera.error());
  camera->fps = fps_of(session.frames);
  session.camera = std::move(*camera);
  return session;
}

bool is_meta_json(const std::filesystem::path& input) {
  const std::optional<Json> json = load(input / "meta.json");
  return json && (json->contains(kCameraAxes) || json->contains(kArkitAxes));
}

}  // namespace

const Importer kMetaJsonImporter{"folder with meta.json, gyro.csv and frames.csv", is_meta_json,
                                 read_meta_json};

}  // namespace gimbal
