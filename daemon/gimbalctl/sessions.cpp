#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "daemon/gimbalctl/commands.hpp"
#include "daemon/gimbalctl/stabilize_report.hpp"
#include "drivers/replay/calibration_keys.hpp"
#include "drivers/replay/import/importer.hpp"
#include "drivers/replay/lens_file.hpp"
#include "drivers/replay/session.hpp"
#include "pipeline/sink/video_file.hpp"

namespace gimbal {

namespace {

using Json = nlohmann::ordered_json;

/// A steady video in a session's folder `stabilized`, and what its report says of it.
struct StabilizedVersion {
  std::filesystem::path video;
  std::uintmax_t bytes = 0;
  std::optional<double> zoom;
  std::optional<double> amount;
};

std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> entries;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    entries.push_back(entry->path());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::optional<double> number(const Json& report, const char* key) {
  if (!report.is_object() || !report.contains(key) || !report[key].is_number()) return std::nullopt;
  return report[key].get<double>();
}

StabilizedVersion describe_version(const std::filesystem::path& video) {
  StabilizedVersion version{video, 0, std::nullopt, std::nullopt};
  std::error_code ignored;
  version.bytes = std::filesystem::file_size(video, ignored);
  std::ifstream file(report_beside(video));
  if (!file) return version;
  const Json report = Json::parse(file, nullptr, false);
  version.zoom = number(report, "zoom");
  version.amount = number(report, "amount");
  return version;
}

std::vector<StabilizedVersion> stabilized_versions(const Session& session) {
  std::vector<StabilizedVersion> versions;
  for (const std::filesystem::path& path : entries_of(session.folder / "stabilized")) {
    const std::string extension = lower_case_extension(path);
    if (extension != ".mp4" && extension != ".mkv" && extension != ".y4m") continue;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) continue;  // a link to what is gone
    versions.push_back(describe_version(path));
  }
  return versions;
}

std::filesystem::path thumbnail(const Session& session) {
  std::filesystem::path path = session.folder / "thumbnail.jpg";
  std::error_code ignored;
  return std::filesystem::exists(path, ignored) ? path : std::filesystem::path();
}

/// Seconds from the first to the last of a log; 0 for fewer than two.
template <typename Sample>
double span_s(const std::vector<Sample>& samples) {
  return samples.empty() ? 0.0 : to_seconds(samples.back().time - samples.front().time);
}

template <typename Sample>
double rate_hz(const std::vector<Sample>& samples) {
  const double span = span_s(samples);
  return span > 0 ? static_cast<double>(samples.size() - 1) / span : 0.0;
}

double duration_s(const Session& session) {
  return session.frames.empty() ? span_s(session.gyro) : span_s(session.frames);
}

template <typename Sample>
Json log_as_json(const std::vector<Sample>& samples) {
  if (samples.empty()) return nullptr;
  return {{"count", samples.size()},
          {"rate_hz", rate_hz(samples)},
          {"first_s", seconds_since_epoch(samples.front().time)},
          {"last_s", seconds_since_epoch(samples.back().time)}};
}

Json matrix_as_json(const Eigen::Matrix3d& M) {
  Json rows = Json::array();
  for (Eigen::Index r = 0; r < 3; ++r) rows.push_back({M(r, 0), M(r, 1), M(r, 2)});
  return rows;
}

Json camera_as_json(const Session& session) {
  const auto& camera = session.camera ? session.camera : session.camera_without_lens;
  if (!camera) return nullptr;
  Json json{{"width", camera->size.width},
            {"height", camera->size.height},
            {"fps", camera->fps},
            {"readout_s", to_seconds(camera->readout)},
            {"time_offset_s", to_seconds(camera->time_offset)},
            {"model", nullptr},
            {"K", nullptr},
            {"distortion", nullptr}};
  if (session.camera) {
    json["model"] = name_of(lens_model_names(), camera->lens.model);
    json["K"] = matrix_as_json(camera->lens.K);
    json["distortion"] = camera->lens.distortion;
  }
  return json;
}

Json path_as_json(const std::filesystem::path& path) {
  return path.empty() ? Json(nullptr) : Json(path.string());
}

Json as_json(const Session& session) {
  Json versions = Json::array();
  for (const StabilizedVersion& version : stabilized_versions(session)) {
    Json json{{"video", version.video.string()}, {"bytes", version.bytes}};
    json["zoom"] = version.zoom ? Json(*version.zoom) : Json(nullptr);
    json["amount"] = version.amount ? Json(*version.amount) : Json(nullptr);
    versions.push_back(std::move(json));
  }
  return {{"folder", session.folder.string()},
          {"device", session.device},
          {"recorded_at", session.recorded_at},
          {"quality", session.quality},
          {"duration_s", duration_s(session)},
          {"original", path_as_json(session.video)},
          {"thumbnail", path_as_json(thumbnail(session))},
          {"camera", camera_as_json(session)},
          {"R_camera_imu", matrix_as_json(session.imu.R_camera_imu)},
          {"clock", session.imu_clock},
          {"frames", log_as_json(session.frames)},
          {"gyro", log_as_json(session.gyro)},
          {"accel", log_as_json(session.accel)},
          {"stabilized", std::move(versions)},
          {"warnings", session.warnings}};
}

void print_field(std::string_view name, std::string_view value) {
  fmt::print("{:<13}{}\n", name, value.empty() ? "unknown" : value);
}

template <typename Sample>
void print_log(std::string_view name, const std::vector<Sample>& samples) {
  if (samples.empty()) return print_field(name, "none");
  print_field(name, fmt::format("{} at {:.1f} Hz, {:.3f} to {:.3f} s", samples.size(),
                                rate_hz(samples), seconds_since_epoch(samples.front().time),
                                seconds_since_epoch(samples.back().time)));
}

void print_camera(const Session& session) {
  const auto& camera = session.camera ? session.camera : session.camera_without_lens;
  if (!camera) return print_field("camera", "not described");
  print_field("camera", fmt::format("{}x{} at {:.2f} fps, readout {:.2f} ms, time offset {:.2f} ms",
                                    camera->size.width, camera->size.height, camera->fps,
                                    to_seconds(camera->readout) * 1e3,
                                    to_seconds(camera->time_offset) * 1e3));
  if (!session.camera) return print_field("lens", "not calibrated");
  const Eigen::Matrix3d& K = camera->lens.K;
  print_field("lens", fmt::format("{}, fx {:.1f} fy {:.1f} cx {:.1f} cy {:.1f}",
                                  name_of(lens_model_names(), camera->lens.model), K(0, 0), K(1, 1),
                                  K(0, 2), K(1, 2)));
}

void print_versions(const Session& session) {
  const std::vector<StabilizedVersion> versions = stabilized_versions(session);
  if (versions.empty()) print_field("stabilized", "none in the folder stabilized");
  for (const StabilizedVersion& version : versions) {
    std::string line = fmt::format("{} ({:.1f} MB", version.video.string(),
                                   static_cast<double>(version.bytes) / 1e6);
    if (version.amount) line += fmt::format(", amount {:.2f}", *version.amount);
    if (version.zoom) line += fmt::format(", zoom {:.3f}", *version.zoom);
    print_field("stabilized", line + ")");
  }
}

void print_warnings(const Session& session) {
  for (const std::string& warning : session.warnings) print_field("warning", warning);
}

void print_session(const Session& session) {
  print_field("session", session.folder.string());
  print_field("device", session.device);
  print_field("recorded at", session.recorded_at);
  print_field("duration", fmt::format("{:.2f} s", duration_s(session)));
  print_field("quality", session.quality);
  print_field("original", session.video.empty() ? "none" : session.video.string());
  const std::filesystem::path picture = thumbnail(session);
  print_field("thumbnail", picture.empty() ? "none" : picture.string());
  print_camera(session);
  print_log("frames", session.frames);
  print_log("gyro", session.gyro);
  print_log("accel", session.accel);
  print_versions(session);
  print_warnings(session);
}

/// One line a session; one that cannot be opened says why.
void print_line(const std::filesystem::path& folder) {
  const Result<Session> session = open_session(folder);
  if (!session) {
    fmt::print("{}  cannot be opened: {}\n", folder.string(), session.error().message);
    return;
  }
  fmt::print("{}  {}  {:.1f} s  {} frames  {}  {} stabilized  {} warnings\n", folder.string(),
             session->recorded_at.empty() ? "undated" : session->recorded_at, duration_s(*session),
             session->frames.size(), session->device.empty() ? "unknown device" : session->device,
             stabilized_versions(*session).size(), session->warnings.size());
}

Result<void> list_sessions(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) {
    return bad_input(fmt::format("{}: not a folder", folder.string()));
  }
  std::size_t count = 0;
  for (const std::filesystem::path& entry : entries_of(folder)) {
    if (!std::filesystem::exists(entry / "session.toml", ignored)) continue;
    print_line(entry);
    ++count;
  }
  if (count == 0) fmt::print(stderr, "gimbalctl: {}: no sessions in it\n", folder.string());
  return {};
}

enum class ShowFormat : std::uint8_t { text, json };

Result<void> show_session(const std::filesystem::path& path, ShowFormat format) {
  const Result<Session> session = open_session(path);
  if (!session) return tl::unexpected(session.error());
  if (format == ShowFormat::json) {
    // Names of files need not be UTF-8, JSON must.
    fmt::print("{}\n", as_json(*session).dump(2, ' ', false, Json::error_handler_t::replace));
  } else {
    print_session(*session);
  }
  return {};
}

struct ImportRequest {
  std::filesystem::path input;
  std::filesystem::path folder;
  std::filesystem::path lens;  ///< empty: as the recording says
};

Result<void> import_recording(const ImportRequest& request) {
  std::optional<LensFile> lens;
  if (!request.lens.empty()) {
    auto read = read_lens_file(request.lens);
    if (!read) return tl::unexpected(read.error());
    lens = std::move(*read);
  }
  const Result<Session> session = import_session(request.input, request.folder, lens);
  if (!session) return tl::unexpected(session.error());
  print_session(*session);
  return {};
}

void add_list(CLI::App& sessions, CommandOutcome& outcome) {
  auto folder = std::make_shared<std::string>(".");
  CLI::App* const list = sessions.add_subcommand("list", "One line for each session in a folder");
  list->add_option("DIR", *folder, "Folder with session folders")->capture_default_str();
  list->callback([folder, &outcome] { outcome = list_sessions(*folder); });
}

void add_show(CLI::App& sessions, CommandOutcome& outcome) {
  auto path = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  CLI::App* const show = sessions.add_subcommand("show", "What a session holds");
  show->add_option("SESSION", *path, "Session folder, or video with a .gcsv beside it")->required();
  show->add_flag("--json", *json, "For programs");
  show->callback([path, json, &outcome] {
    outcome = show_session(*path, *json ? ShowFormat::json : ShowFormat::text);
  });
}

void add_import(CLI::App& sessions, CommandOutcome& outcome) {
  auto request = std::make_shared<ImportRequest>();
  CLI::App* const command =
      sessions.add_subcommand("import", "Turn a recording of another kind into a session");
  std::vector<std::string_view> kinds;
  for (const Importer& importer : importers()) kinds.push_back(importer.kind);
  command->add_option("INPUT", request->input, fmt::format("{}", fmt::join(kinds, "; or ")))
      ->required();
  command->add_option("-o,--output", request->folder, "New session folder")->required();
  command->add_option("--lens", request->lens,
                      "Gyroflow's lens profile (.json), or a calibration by Kalibr, OpenCV or ROS "
                      "(.yaml)");
  command->callback([request, &outcome] { outcome = import_recording(*request); });
}

}  // namespace

void add_sessions_command(CLI::App& app, CommandOutcome& outcome) {
  CLI::App* const sessions = app.add_subcommand("sessions", "List, show and import recordings");
  sessions->require_subcommand(1);
  add_list(*sessions, outcome);
  add_show(*sessions, outcome);
  add_import(*sessions, outcome);
}

}  // namespace gimbal
