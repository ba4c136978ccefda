#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "drivers/replay/csv.hpp"
#include "drivers/replay/import/importer.hpp"
#include "drivers/replay/import/phone.hpp"
#include "drivers/replay/stamped_log.hpp"
#include "drivers/replay/video_probe.hpp"

namespace gimbal {

namespace {

/// A phone that focuses or steadies its lens changes it with every frame.
struct LoggedFrames {
  std::vector<FrameStamp> stamps;
  std::array<std::vector<double>, 4> fx_fy_cx_cy;
};

/// A row t,n,fx,fy,cx,cy. A frame without a usable time is passed over.
Result<void> read_frame(const CsvReader& reader, const CsvRow& row, LoggedFrames& frames) {
  const Result<std::optional<SensorDuration>> time = reader.time(row, 0, TimeUnit::seconds);
  if (!time) return tl::unexpected(time.error());
  const Result<std::int64_t> index = reader.integer(row, 1);
  if (!index) return tl::unexpected(index.error());
  for (std::size_t i = 0; i < frames.fx_fy_cx_cy.size(); ++i) {
    const Result<double> value = reader.number(row, 2 + i);
    if (!value) return tl::unexpected(value.error());
    frames.fx_fy_cx_cy[i].push_back(*value);
  }
  if (*time) frames.stamps.push_back({*index, SensorTime(**time), std::nullopt});
  return {};
}

Result<LoggedFrames> read_frames(const std::filesystem::path& path) {
  Result<CsvReader> reader = CsvReader::open_headerless(
      path, {{"t", 0}, {"n", 1}, {"fx", 2}, {"fy", 3}, {"cx", 4}, {"cy", 5}}, ',');
  if (!reader) return tl::unexpected(reader.error());
  LoggedFrames frames;
  while (true) {
    const Result<std::optional<CsvRow>> row = reader->next();
    if (!row) return tl::unexpected(row.error());
    if (!*row) break;
    if (Result<void> read = read_frame(*reader, **row, frames); !read) {
      return tl::unexpected(read.error());
    }
  }
  if (frames.stamps.empty()) return bad_input(fmt::format("{}: no frames in it", path.string()));
  // Some count from 1; the video's first picture is 0.
  const std::int64_t first = frames.stamps.front().index;
  for (FrameStamp& stamp : frames.stamps) stamp.index -= first;
  return frames;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double spread(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *most - *least;
}

template <typename Sample>
Result<std::vector<Sample>> read_vector_file(const std::filesystem::path& path, double factor,
                                             std::vector<std::string>& warnings) {
  Result<CsvReader> reader =
      CsvReader::open_headerless(path, {{"t", 0}, {"x", 1}, {"y", 2}, {"z", 3}}, ',');
  if (!reader) return tl::unexpected(reader.error());
  Result<StampedLog<Sample>> log =
      read_vectors<Sample>(*reader, {TimeUnit::seconds, factor}, warnings);
  if (!log) return tl::unexpected(log.error());
  return std::move(log->samples);
}

/// K belongs to the size of the pictures, which only the video tells.
Result<CameraCalibration> read_camera(const LoggedFrames& frames,
                                      const std::filesystem::path& video) {
  const Result<VideoInfo> info = probe_video(video);
  if (!info) return tl::unexpected(info.error());
  const auto& [fx, fy, cx, cy] = frames.fx_fy_cx_cy;
  CameraCalibration camera;
  camera.size = info->size;
  camera.lens.K << median(fx), 0, median(cx), 0, median(fy), median(cy), 0, 0, 1;
  const double step_s = to_seconds(median_step(frames.stamps));
  if (step_s > 0) camera.fps = 1.0 / step_s;
  return camera;
}

Result<Session> read_ios_logger(const std::filesystem::path& input) {
  Session session;
  const Result<LoggedFrames> frames = read_frames(input / "Frames.txt");
  if (!frames) return tl::unexpected(frames.error());
  auto gyro = read_vector_file<GyroSample>(input / "Gyro.txt", 1.0, session.warnings);
  if (!gyro) return tl::unexpected(gyro.error());
  std::error_code ignored;
  if (const std::filesystem::path path = input / "Accel.txt";
      std::filesystem::exists(path, ignored)) {
    auto accel =
        read_vector_file<AccelSample>(path, kCoreMotionToSpecificForce_m_s2, session.warnings);
    if (!accel) return tl::unexpected(accel.error());
    session.accel = std::move(*accel);
  }
  session.device = "iOS logger";
  session.gyro = std::move(*gyro);
  session.frames = frames->stamps;
  session.imu.R_camera_imu = R_landscape_camera_phone();
  session.imu_clock = "seconds since 1970";
  session.video = find_video(input);
  if (!session.video.empty()) {
    Result<CameraCalibration> camera = read_camera(*frames, session.video);
    if (!camera) return tl::unexpected(camera.error());
    session.camera = std::move(*camera);
  }
  session.notes = {
      "From an iOS logger folder: the rear camera, held in landscape. Accelerometer turned from "
      "CoreMotion's sign and g.",
      fmt::format("K is the median over the frames; fx varied by {:.1f} px.",
                  spread(frames->fx_fy_cx_cy[0])),
      "The log does not tell readout_s and time_offset_s: both stand at 0."};
  return session;
}

bool is_ios_logger(const std::filesystem::path& input) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(input / "Gyro.txt", ignored) &&
         std::filesystem::is_regular_file(input / "Frames.txt", ignored);
}

}  // namespace

const Importer kIosLoggerImporter{"iOS logger folder with Gyro.txt and Frames.txt", is_ios_logger,
                                  read_ios_logger};

}  // namespace gimbal
