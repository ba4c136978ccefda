#include "drivers/replay/gcsv.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <system_error>
#include <utility>

#include "drivers/replay/csv.hpp"
#include "drivers/replay/in_quotes.hpp"
#include "drivers/replay/video_probe.hpp"
#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {

namespace {

/// The lines before the table: names and values.
using Header = std::map<std::string, std::string, std::less<>>;

/// What a row's numbers are multiplied by, and which stored axis each of Gyroflow's comes from.
struct Scales {
  double seconds_per_tick = 0.001;
  double rad_s_per_gyro = 1.0;
  double m_s2_per_accel = kStandardGravity_m_s2;
  Eigen::Matrix3d M_gyroflow_stored = Eigen::Matrix3d::Identity();
};

std::string text_of(const Header& header, std::string_view key, std::string_view otherwise) {
  const auto found = header.find(key);
  return found == header.end() ? std::string(otherwise) : found->second;
}

Result<double> number_of(const std::filesystem::path& path, const Header& header,
                         std::string_view key, double otherwise) {
  const auto found = header.find(key);
  if (found == header.end()) return otherwise;
  const std::optional<double> value = parse_number(found->second);
  if (value && std::isfinite(*value)) return *value;
  return bad_input(fmt::format("{}: {} is {}; a number is expected", path.string(), key,
                               in_quotes(found->second)));
}

/// "xzY": Gyroflow's x is the stored x turned round, its y the stored z turned round, its z the
/// stored y. The default mirrors the axes, which is why this is applied to the samples and cannot
/// be a part of R_camera_imu.
Result<Eigen::Matrix3d> read_orientation(const std::filesystem::path& path, const Header& header) {
  const std::string letters = text_of(header, "orientation", "xzY");
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  for (int row = 0; row < 3 && letters.size() == 3; ++row) {
    constexpr std::string_view kNames = "XYZxyz";
    const std::size_t place = kNames.find(letters[static_cast<std::size_t>(row)]);
    if (place != std::string_view::npos) M(row, static_cast<int>(place % 3)) = place < 3 ? 1 : -1;
  }
  if (M.cwiseAbs().rowwise().sum().isOnes() && M.cwiseAbs().colwise().sum().isOnes()) return M;
  return bad_input(
      fmt::format("{}: orientation is {}; each of X, Y and Z is expected once, small "
                  "letters for the opposite direction",
                  path.string(), in_quotes(letters)));
}

Result<Scales> read_scales(const std::filesystem::path& path, const Header& header) {
  const Result<double> time = number_of(path, header, "tscale", 0.001);
  const Result<double> gyro = number_of(path, header, "gscale", 1.0);
  const Result<double> accel = number_of(path, header, "ascale", 1.0);
  for (const Result<double>* scale : {&time, &gyro, &accel}) {
    if (!*scale) return tl::unexpected(scale->error());
  }
  if (*time <= 0) return bad_input(fmt::format("{}: tscale is not above 0", path.string()));
  const Result<Eigen::Matrix3d> orientation = read_orientation(path, header);
  if (!orientation) return tl::unexpected(orientation.error());
  return Scales{*time, *gyro, *accel * kStandardGravity_m_s2, *orientation};
}

/// Negative times stand for the opposite direction in older logs.
Result<void> read_readout(const std::filesystem::path& path, const Header& header,
                          GyroflowLog& log) {
  constexpr std::array<ReadoutDirection, 4> kDirections{
      ReadoutDirection::top_down, ReadoutDirection::bottom_up, ReadoutDirection::left_right,
      ReadoutDirection::right_left};
  constexpr double kLongest_ms = 1000;
  const Result<double> readout_ms = number_of(path, header, "frame_readout_time", 0.0);
  if (!readout_ms) return tl::unexpected(readout_ms.error());
  const std::string direction = text_of(header, "frame_readout_direction", "0");
  if (direction.size() != 1 || direction[0] < '0' || direction[0] > '3') {
    return bad_input(fmt::format("{}: frame_readout_direction is {}; 0 to 3 are expected",
                                 path.string(), in_quotes(direction)));
  }
  if (std::abs(*readout_ms) > kLongest_ms) {
    return bad_input(fmt::format("{}: frame_readout_time is {} ms; at most {} are expected",
                                 path.string(), *readout_ms, kLongest_ms));
  }
  log.readout = duration_from_seconds(std::abs(*readout_ms) / 1000);
  const std::size_t opposite = *readout_ms < 0 ? 1 : 0;
  log.readout_direction = kDirections[static_cast<std::size_t>(direction[0] - '0') ^ opposite];
  return {};
}

/// Ticks as time: to the nanosecond where a tick is a power of ten of a second.
Result<std::optional<SensorDuration>> read_time(const CsvReader& reader, const CsvRow& row,
                                                double seconds_per_tick) {
  for (const auto& [seconds, unit] :
       {std::pair(1.0, TimeUnit::seconds), std::pair(1e-3, TimeUnit::milliseconds),
        std::pair(1e-6, TimeUnit::microseconds), std::pair(1e-9, TimeUnit::nanoseconds)}) {
    if (seconds == seconds_per_tick) return reader.time(row, 0, unit);
  }
  const Result<double> ticks = reader.number(row, 0);
  if (!ticks) return tl::unexpected(ticks.error());
  const double time_s = *ticks * seconds_per_tick;
  constexpr double kLongest_s = 4e9;
  if (std::abs(time_s) > kLongest_s) return reader.error_at(row, 0, "too large for a time");
  return std::isfinite(time_s) ? std::optional(duration_from_seconds(time_s)) : std::nullopt;
}

/// Three columns from `first` on; nothing if one is empty.
Result<std::optional<Eigen::Vector3d>> read_vector(const CsvReader& reader, const CsvRow& row,
                                                   std::size_t first) {
  Eigen::Vector3d vector;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (row.fields[first + axis].empty()) return std::optional<Eigen::Vector3d>();
    const Result<double> value = reader.number(row, first + axis);
    if (!value) return tl::unexpected(value.error());
    vector[static_cast<Eigen::Index>(axis)] = *value;
  }
  return std::optional(vector);
}

/// Appends a row to both logs; counts it if something in it is not finite.
Result<void> read_row(const CsvReader& reader, const CsvRow& row, const Scales& scales,
                      GyroflowLog& log) {
  const Result<std::optional<SensorDuration>> time =
      read_time(reader, row, scales.seconds_per_tick);
  if (!time) return tl::unexpected(time.error());
  const Result<std::optional<Eigen::Vector3d>> gyro = read_vector(reader, row, 1);
  const Result<std::optional<Eigen::Vector3d>> accel = read_vector(reader, row, 4);
  if (!gyro) return tl::unexpected(gyro.error());
  if (!accel) return tl::unexpected(accel.error());
  if (!*time || (*gyro && !(*gyro)->allFinite()) || (*accel && !(*accel)->allFinite())) {
    ++log.gyro.rows_not_finite;
    return {};
  }
  if (*gyro) {
    const Eigen::Vector3d axes = scales.M_gyroflow_stored * **gyro;
    log.gyro.samples.push_back({SensorTime(**time), axes * scales.rad_s_per_gyro});
    log.gyro.lines.push_back(row.line);
  }
  if (*accel) {
    const Eigen::Vector3d axes = scales.M_gyroflow_stored * **accel;
    log.accel.samples.push_back({SensorTime(**time), axes * scales.m_s2_per_accel});
    log.accel.lines.push_back(row.line);
  }
  return {};
}

bool is_table_header(const CsvRow& row) {
  return row.fields[0] == "t" || row.fields[0] == "time";
}

/// Reads up to and with the line that names the columns.
Result<Header> read_header(CsvReader& reader) {
  constexpr std::size_t kLongestHeader = 200;
  Header header;
  for (std::size_t line = 0; line < kLongestHeader; ++line) {
    const Result<std::optional<CsvRow>> row = reader.next();
    if (!row) return tl::unexpected(row.error());
    if (!*row) break;
    if (is_table_header(**row)) return header;
    if (line == 0 && !(*row)->fields[0].ends_with("IMU LOG")) break;
    header.emplace((*row)->fields[0], (*row)->fields[1]);
  }
  return bad_input(fmt::format(
      "{}: not a Gyroflow log; GYROFLOW IMU LOG, a header and a line t,gx,gy,gz are expected",
      reader.path().string()));
}

std::vector<FrameStamp> frames_of(const VideoInfo& video) {
  std::vector<FrameStamp> frames;
  for (std::int64_t i = 0; i < video.frame_count; ++i) {
    const SensorDuration time = video.frame_times.empty()
                                    ? duration_from_seconds(static_cast<double>(i) / video.fps)
                                    : video.frame_times[static_cast<std::size_t>(i)];
    frames.push_back({i, SensorTime(time), std::nullopt});
  }
  return frames;
}

/// Gyroflow's frame time is the middle of the readout.
CameraCalibration camera_of(const VideoInfo& video, const GyroflowLog& log) {
  CameraCalibration camera;
  camera.size = video.size;
  camera.fps = video.fps;
  camera.readout = log.readout;
  camera.readout_direction = log.readout_direction;
  camera.time_offset = -log.readout / 2;
  return camera;
}

}  // namespace

Eigen::Matrix3d R_camera_gyroflow() {
  Eigen::Matrix3d R;
  R << 0, -1, 0,  //
      -1, 0, 0,   //
      0, 0, -1;
  return R;
}

Result<GyroflowLog> read_gcsv(const std::filesystem::path& path,
                              std::vector<std::string>& warnings) {
  std::vector<CsvReader::PlacedColumn> columns{{"t", 0}};
  for (const char* name : {"gx", "gy", "gz", "ax", "ay", "az"}) {
    columns.push_back({name, columns.size(), CsvReader::Presence::optional});
  }
  Result<CsvReader> reader = CsvReader::open_headerless(path, columns, ',');
  if (!reader) return tl::unexpected(reader.error());
  const Result<Header> header = read_header(*reader);
  if (!header) return tl::unexpected(header.error());
  const Result<Scales> scales = read_scales(path, *header);
  if (!scales) return tl::unexpected(scales.error());
  GyroflowLog log;
  log.device = text_of(*header, "vendor", text_of(*header, "id", ""));
  log.note = text_of(*header, "note", "");
  log.gyro.file = path;
  log.accel.file = path;
  if (Result<void> read = read_readout(path, *header, log); !read) {
    return tl::unexpected(read.error());
  }
  while (true) {
    const Result<std::optional<CsvRow>> row = reader->next();
    if (!row) return tl::unexpected(row.error());
    if (!*row) break;
    if (Result<void> read = read_row(*reader, **row, *scales, log); !read) {
      return tl::unexpected(read.error());
    }
  }
  if (log.gyro.rows_not_finite > 0) {
    warnings.push_back(fmt::format("{}: {} rows left out with values that are not finite",
                                   path.filename().string(), log.gyro.rows_not_finite));
  }
  if (Result<void> usable = check_has_samples(log.gyro); !usable) {
    return tl::unexpected(usable.error());
  }
  return log;
}

std::filesystem::path gcsv_beside(const std::filesystem::path& video) {
  std::error_code ignored;
  for (const char* extension : {".gcsv", ".GCSV"}) {
    std::filesystem::path log = video;
    log.replace_extension(extension);
    if (std::filesystem::is_regular_file(log, ignored)) return log;
  }
  return {};
}

Result<std::pair<Session, SessionLogs>> read_gyroflow_recording(const std::filesystem::path& video,
                                                                const std::filesystem::path& log) {
  Session session;
  Result<GyroflowLog> gyroflow = read_gcsv(log, session.warnings);
  if (!gyroflow) return tl::unexpected(gyroflow.error());
  const Result<VideoInfo> info = probe_video(video);
  if (!info) return tl::unexpected(info.error());
  if (info->frame_times.empty() && !(info->fps > 0)) {
    return bad_input(fmt::format("{}: neither frame times nor a frame rate in it", video.string()));
  }
  session.folder = video.parent_path();
  session.device = gyroflow->device;
  session.camera_without_lens = camera_of(*info, *gyroflow);
  session.imu.R_camera_imu = R_camera_gyroflow();
  session.imu_clock = "video";
  session.video = video;
  session.warnings.push_back(
      fmt::format("{}: frame times are the video's own ({:.2f} fps), and the log is taken to begin "
                  "with it; if it does not, make a session of it (gimbalctl sessions import) and "
                  "set camera.time_offset_s there",
                  video.filename().string(), info->fps));
  session.notes = {
      "From a video with a Gyroflow log. Frame times are the video's own.",
      "IMU axes are Gyroflow's: x up, y left, z back.",
      "time_offset_s moves Gyroflow's frame times, in the middle of the readout, to its "
      "start; when the log began is not known, it is taken to have begun with the video."};
  SessionLogs logs;
  logs.frames.file = video;
  logs.frames.samples = frames_of(*info);
  for (const FrameStamp& stamp : logs.frames.samples) logs.frames.lines.push_back(stamp.index);
  logs.gyro = std::move(gyroflow->gyro);
  logs.accel = std::move(gyroflow->accel);
  return std::pair(std::move(session), std::move(logs));
}

}  // namespace gimbal
