#include "drivers/replay/session_toml.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>

#include "drivers/replay/calibration_keys.hpp"
#include "drivers/replay/decimal_time.hpp"
#include "drivers/replay/toml_reader.hpp"
#include "pipeline/lens/lens.hpp"
#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {

namespace {

constexpr int kLargestSide_px = 65535;
/// A frame, and what rounding adds.
constexpr double kLongestReadout_frames = 1.01;

constexpr std::array<NamedValue<double>, 2> kAccelUnits{
    {{"m/s2", 1.0}, {"g", kStandardGravity_m_s2}}};
/// CoreMotion's numbers have the sign of gravity: face up reads (0, 0, -1).
constexpr std::array<NamedValue<double>, 2> kAccelSigns{
    {{"specific-force", 1.0}, {"core-motion", -1.0}}};

/// All of [camera] but K, whose presence decides whether the lens is calibrated.
CameraCalibration read_camera_without_K(TomlTable& table) {
  CameraCalibration camera;
  camera.size.width = table.integer("width", 1, kLargestSide_px).value_or(0);
  camera.size.height = table.integer("height", 1, kLargestSide_px).value_or(0);
  camera.fps = table.number("fps").value_or(0);
  if (camera.fps < 0 || camera.fps > 1e5) table.refuse("fps", "must be between 0 and 100000");
  camera.lens.model =
      table.choice<LensModel>("model", lens_model_names()).value_or(LensModel::pinhole);
  camera.lens.distortion = table.numbers("distortion").value_or(std::vector<double>{});
  camera.readout = read_readout(table).value_or(SensorDuration{});
  camera.readout_direction =
      table.choice<ReadoutDirection>("readout_direction", readout_direction_names())
          .value_or(ReadoutDirection::top_down);
  camera.time_offset = read_time_offset(table).value_or(SensorDuration{});
  camera.timestamp = table.choice<TimestampReference>("timestamp", timestamp_names())
                         .value_or(TimestampReference::readout_start);
  return camera;
}

/// Takes K into the camera, and checks the lens that it makes complete.
void read_K(TomlTable& table, CameraCalibration& camera) {
  const std::optional<Eigen::Matrix3d> K = table.matrix3("K");
  if (!K) return;
  camera.lens.K = *K;
  if (camera.size.width == 0 || camera.size.height == 0) {
    table.refuse("K", "needs width and height, the size of picture that it is for");
  }
  if (const Result<Lens> lens = Lens::create(camera.lens); !lens) {
    table.refuse("K", fmt::format("or distortion cannot be used: {}", lens.error().message));
  }
}

bool is_inside(const Eigen::Matrix3d& K, ImageSize size) {
  return K(0, 2) > 0 && K(0, 2) < size.width && K(1, 2) > 0 && K(1, 2) < size.height;
}

Result<void> read_camera(TomlTable& table, SessionToml& out) {
  CameraCalibration camera = read_camera_without_K(table);
  read_K(table, camera);
  if (table.error()) return tl::unexpected(*table.error());
  if (camera.readout == SensorDuration{}) {
    out.warnings.emplace_back(
        "session.toml: camera.readout_s is 0 or not given: rows count as exposed at once; give the "
        "seconds that the sensor takes from its first row to its last");
  }
  if (camera.fps > 0 && to_seconds(camera.readout) * camera.fps > kLongestReadout_frames) {
    out.warnings.push_back(fmt::format(
        "session.toml: camera.readout_s is {}, longer than a frame at {} fps: no sensor reads so "
        "slowly; is it in seconds?",
        to_seconds(camera.readout), camera.fps));
  }
  if (table.has("K") && !is_inside(camera.lens.K, camera.size)) {
    out.warnings.push_back(fmt::format(
        "session.toml: camera.K has its centre at ({}, {}), outside the {}x{} picture: is K for "
        "another size?",
        camera.lens.K(0, 2), camera.lens.K(1, 2), camera.size.width, camera.size.height));
  }
  if (table.has("K")) {
    out.session.camera = std::move(camera);
  } else {
    out.warnings.emplace_back(
        "session.toml: camera.K is not given: the lens is not calibrated; give "
        "[[fx, 0, cx], [0, fy, cy], [0, 0, 1]] in pixels, for instance from OpenCV's "
        "calibrateCamera");
    out.session.camera_without_lens = std::move(camera);
  }
  return {};
}

Result<void> read_imu(TomlTable& table, SessionToml& out) {
  out.session.imu.delay = read_imu_delay(table);
  out.session.imu.R_camera_imu =
      read_rotation(table, "R_camera_imu").value_or(Eigen::Matrix3d::Identity());
  out.accel_to_specific_force_m_s2 = table.choice<double>("accel_unit", kAccelUnits).value_or(1.0) *
                                     table.choice<double>("accel_sign", kAccelSigns).value_or(1.0);
  out.session.imu_clock = table.text("clock").value_or("");
  if (table.error()) return tl::unexpected(*table.error());
  return {};
}

void append(std::vector<std::string>& to, std::vector<std::string> from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

/// A TOML basic string.
std::string in_toml_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      out += fmt::format("\\u{:04X}", byte);
    } else {
      out += c;
    }
  }
  return out + '"';
}

/// Shortest text that reads back as the same float; TOML wants a digit that tells it from a whole.
std::string format_float(double value) {
  const std::string text = fmt::format("{}", value);
  return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
}

std::string format_matrix(const Eigen::Matrix3d& matrix) {
  std::array<std::string, 3> rows;
  for (Eigen::Index r = 0; r < 3; ++r) {
    rows[static_cast<std::size_t>(r)] =
        fmt::format("[{}, {}, {}]", format_float(matrix(r, 0)), format_float(matrix(r, 1)),
                    format_float(matrix(r, 2)));
  }
  return fmt::format("[{}]", fmt::join(rows, ", "));
}

/// Nanosecond digits that say nothing are left away.
std::string format_duration(SensorDuration duration) {
  std::string text = format_seconds(duration);
  const std::size_t last = text.find_last_not_of('0');
  text.resize(text[last] == '.' ? last + 2 : last + 1);
  return text;
}

std::string format_lens(const LensParameters& lens) {
  std::vector<std::string> distortion;
  distortion.reserve(lens.distortion.size());
  for (const double coefficient : lens.distortion) distortion.push_back(format_float(coefficient));
  return fmt::format("model = \"{}\"\nK = {}\ndistortion = [{}]\n",
                     name_of(lens_model_names(), lens.model), format_matrix(lens.K),
                     fmt::join(distortion, ", "));
}

std::string format_camera(const CameraCalibration& camera, std::string_view lens) {
  std::string out = "\n[camera]\n";
  if (camera.size.width > 0 && camera.size.height > 0) {
    out += fmt::format("width = {}\nheight = {}\n", camera.size.width, camera.size.height);
  }
  if (camera.fps > 0) out += fmt::format("fps = {}\n", format_float(camera.fps));
  out += lens;
  out +=
      fmt::format("readout_s = {}\nreadout_direction = \"{}\"\n", format_duration(camera.readout),
                  name_of(readout_direction_names(), camera.readout_direction));
  out +=
      fmt::format("time_offset_s = {}\ntimestamp = \"{}\"\n", format_duration(camera.time_offset),
                  name_of(timestamp_names(), camera.timestamp));
  return out;
}

SensorDuration span_of(const Session& session) {
  const auto span = [](const auto& samples) {
    return samples.empty() ? SensorDuration{} : samples.back().time - samples.front().time;
  };
  return session.frames.empty() ? span(session.gyro) : span(session.frames);
}

}  // namespace

Result<SessionToml> read_session_toml(const std::filesystem::path& path) {
  Result<TomlTable> root = TomlTable::load(path);
  if (!root) return tl::unexpected(root.error());
  SessionToml out;
  out.session.device = root->text("device").value_or("");
  out.session.recorded_at = root->date("recorded_at").value_or("");
  out.session.quality = root->text("quality").value_or("");
  static_cast<void>(root->number("duration_s"));  // for people; the logs say it better
  std::optional<TomlTable> camera = root->table("camera");
  std::optional<TomlTable> imu = root->table("imu");
  if (root->error()) return tl::unexpected(*root->error());
  append(out.warnings, root->unknown_keys());
  if (camera) {
    if (Result<void> read = read_camera(*camera, out); !read) return tl::unexpected(read.error());
    append(out.warnings, camera->unknown_keys());
  }
  if (imu) {
    if (Result<void> read = read_imu(*imu, out); !read) return tl::unexpected(read.error());
    append(out.warnings, imu->unknown_keys());
  }
  return out;
}

std::string format_session_toml(const Session& session) {
  std::string out;
  for (const std::string& note : session.notes) out += fmt::format("# {}\n", note);
  const auto add_text = [&](std::string_view key, const std::string& value) {
    if (!value.empty()) out += fmt::format("{} = {}\n", key, in_toml_quotes(value));
  };
  add_text("device", session.device);
  add_text("recorded_at", session.recorded_at);
  out += fmt::format("duration_s = {}\n", format_duration(span_of(session)));
  add_text("quality", session.quality);
  if (session.camera) {
    out += format_camera(*session.camera, format_lens(session.camera->lens));
  } else if (session.camera_without_lens) {
    out += format_camera(*session.camera_without_lens, "");
  }
  out += fmt::format("\n[imu]\nR_camera_imu = {}\n", format_matrix(session.imu.R_camera_imu));
  if (session.imu.delay) {
    out += fmt::format("delay_s = {}\n", format_duration(*session.imu.delay));
  }
  if (!session.accel.empty()) out += "accel_unit = \"m/s2\"\naccel_sign = \"specific-force\"\n";
  add_text("clock", session.imu_clock);
  return out;
}

}  // namespace gimbal
