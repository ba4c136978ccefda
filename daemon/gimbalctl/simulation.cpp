#include "daemon/gimbalctl/simulation.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "daemon/gimbalctl/data_files.hpp"
#include "daemon/gimbalctl/progress_bar.hpp"
#include "drivers/replay/decimal_time.hpp"
#include "drivers/replay/replay_camera.hpp"
#include "drivers/replay/session.hpp"
#include "drivers/replay/session_toml.hpp"
#include "drivers/replay/still.hpp"
#include "drivers/synthetic/hand_motion.hpp"
#include "drivers/synthetic/picture_scene.hpp"
#include "drivers/synthetic/recorded_motion.hpp"
#include "drivers/synthetic/street_scene.hpp"
#include "drivers/synthetic/synthetic_camera.hpp"
#include "drivers/synthetic/synthetic_imu.hpp"
#include "pipeline/sink/frame_sink.hpp"

namespace gimbal {
namespace {

/// Clocks have run for a while when a recording begins, so that no stamp is below zero.
constexpr SensorDuration kClockAtStart = std::chrono::seconds(1);
/// The IMU is on a little before the first frame and after the last.
constexpr SensorDuration kLead = std::chrono::milliseconds(200);
constexpr int kThumbnailWidth_px = 320;

template <typename T>
tl::unexpected<Error> error_of(const Result<T>& result) {
  return tl::unexpected<Error>(result.error());
}

SensorDuration milliseconds_of(double ms) {
  return duration_from_seconds(ms * 1e-3);
}

// --- motion -----------------------------------------------------------------------------------

const std::map<std::string, HandModel (*)()>& hand_models() {
  static const std::map<std::string, HandModel (*)()> models = {{"walk", walking_hand},
                                                                {"run", running_hand},
                                                                {"pan", panning_hand},
                                                                {"vehicle", vehicle_mount},
                                                                {"tripod", tripod}};
  return models;
}

Result<std::filesystem::path> find_motion_log(const std::string& name) {
  std::error_code ignored;
  if (std::filesystem::exists(name, ignored)) return name;
  return find_data_file("motions", name == "iphone" ? "iphone-handheld" : name)
      .map_error([&](Error error) {
        error.message += "; or walk, run, pan, vehicle, tripod";
        return error;
      });
}

Result<Motion> load_recorded_motion(const SimulationOptions& options) {
  const Result<std::filesystem::path> path = find_motion_log(options.motion);
  if (!path) return error_of(path);
  const Result<Session> log = open_session(*path);
  if (!log) return error_of(log);
  return make_recorded_motion({log->gyro, log->accel, log->imu.R_camera_imu},
                              duration_from_seconds(options.start_s),
                              duration_from_seconds(options.duration_s))
      .map_error([&](Error error) {
        error.message = fmt::format("{}: {}", path->string(), error.message);
        return error;
      });
}

/// Frames begin at kClockAtStart.
Result<Motion> make_motion(const SimulationOptions& options) {
  const auto model = hand_models().find(options.motion);
  const Result<Motion> motion =
      model == hand_models().end()
          ? load_recorded_motion(options)
          : make_hand_motion(model->second(), duration_from_seconds(options.duration_s),
                             options.seed);
  if (!motion) return error_of(motion);
  return motion->delayed(kClockAtStart);
}

// --- camera -----------------------------------------------------------------------------------

Result<ImageSize> parse_size(const std::string& text) {
  ImageSize size;
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  if (width.ec == std::errc() && width.ptr != end && *width.ptr == 'x') {
    const auto height = std::from_chars(width.ptr + 1, end, size.height);
    const bool whole = height.ec == std::errc() && height.ptr == end;
    const auto fits = [](int side) { return side >= 16 && side <= 8192 && side % 2 == 0; };
    if (whole && fits(size.width) && fits(size.height)) return size;
  }
  return bad_input(fmt::format(
      "--size {}: write WIDTHxHEIGHT, such as 1280x720, each even and from 16 to 8192", text));
}

/// The same view in another size: K with pixel centres at whole coordinates.
void resize(CameraCalibration& camera, ImageSize size) {
  const double x = static_cast<double>(size.width) / camera.size.width;
  const double y = static_cast<double>(size.height) / camera.size.height;
  Eigen::Matrix3d& K = camera.lens.K;
  K(0, 0) *= x;
  K(1, 1) *= y;
  K(0, 2) = (K(0, 2) + 0.5) * x - 0.5;
  K(1, 2) = (K(1, 2) + 0.5) * y - 0.5;
  camera.size = size;
}

template <typename T>
Result<T> choice(const char* option, const std::string& word,
                 const std::map<std::string, T>& choices) {
  const auto found = choices.find(word);
  if (found != choices.end()) return found->second;
  std::string allowed;
  for (const auto& [name, value] : choices) allowed += (allowed.empty() ? "" : ", ") + name;
  return bad_input(fmt::format("{} {}: choose one of {}", option, word, allowed));
}

Result<void> apply_words(const SimulationOptions& options, CameraCalibration& camera) {
  if (options.readout_direction) {
    const auto direction =
        choice<ReadoutDirection>("--readout-direction", *options.readout_direction,
                                 {{"top-down", ReadoutDirection::top_down},
                                  {"bottom-up", ReadoutDirection::bottom_up},
                                  {"left-right", ReadoutDirection::left_right},
                                  {"right-left", ReadoutDirection::right_left}});
    if (!direction) return error_of(direction);
    camera.readout_direction = *direction;
  }
  if (options.timestamp) {
    const auto reference =
        choice<TimestampReference>("--timestamp", *options.timestamp,
                                   {{"readout-start", TimestampReference::readout_start},
                                    {"exposure-start", TimestampReference::exposure_start},
                                    {"readout-end", TimestampReference::readout_end}});
    if (!reference) return error_of(reference);
    camera.timestamp = *reference;
  }
  return {};
}

/// The camera's session.toml, with what the options change.
Result<Session> load_camera(const SimulationOptions& options) {
  std::error_code ignored;
  const Result<std::filesystem::path> path = std::filesystem::exists(options.camera, ignored)
                                                 ? Result<std::filesystem::path>(options.camera)
                                                 : find_data_file("cameras", options.camera);
  if (!path) return error_of(path);
  Result<SessionToml> toml = read_session_toml(*path);
  if (!toml) return error_of(toml);
  Session session = std::move(toml->session);
  if (!session.camera || session.camera->fps <= 0) {
    return bad_input(
        fmt::format("{}: needs a [camera] table with width, height, fps and K", path->string()));
  }
  CameraCalibration& camera = *session.camera;
  if (!options.size.empty()) {
    const Result<ImageSize> size = parse_size(options.size);
    if (!size) return error_of(size);
    resize(camera, *size);
  }
  camera.fps = options.fps.value_or(camera.fps);
  if (options.readout_ms) camera.readout = milliseconds_of(*options.readout_ms);
  if (options.time_offset_ms) camera.time_offset = milliseconds_of(*options.time_offset_ms);
  if (Result<void> applied = apply_words(options, camera); !applied) return error_of(applied);
  return session;
}

// --- scene ------------------------------------------------------------------------------------

Result<VideoFrame> load_picture(const std::string& path) {
  ReplayCamera picture(path, {FrameStamp{}}, 1.0);
  if (Result<void> started = picture.start(); !started) return error_of(started);
  Result<std::optional<VideoFrame>> frame = picture.read();
  if (!frame) return error_of(frame);
  if (!*frame) return bad_input(fmt::format("{}: there is no picture in it", path));
  return **frame;
}

Result<std::shared_ptr<const Panorama>> make_panorama(const SimulationOptions& options,
                                                      const CameraCalibration& camera) {
  constexpr double kPictureWidth_rad = 100.0 * std::numbers::pi / 180.0;
  constexpr int kSamples = 2;
  const double pixels_per_radian = std::max(camera.lens.K(0, 0), camera.lens.K(1, 1));
  if (options.scene == "street") {
    return std::make_shared<const Panorama>(
        std::make_shared<StreetScene>(options.seed, 1.0 / pixels_per_radian), pixels_per_radian,
        kSamples);
  }
  Result<VideoFrame> picture = load_picture(options.scene);
  if (!picture) return error_of(picture);
  return std::make_shared<const Panorama>(
      std::make_shared<PictureScene>(*std::move(picture), kPictureWidth_rad), pixels_per_radian,
      kSamples);
}

// --- devices ----------------------------------------------------------------------------------

Result<std::unique_ptr<SyntheticCamera>> make_camera(const SimulationOptions& options,
                                                     const CameraCalibration& calibration,
                                                     std::shared_ptr<const Motion> motion) {
  SyntheticCameraSettings settings;
  settings.calibration = calibration;
  settings.exposure = milliseconds_of(options.exposure_ms);
  settings.first_readout = SensorTime(kClockAtStart);
  settings.frames = std::llround(options.duration_s * calibration.fps);
  settings.interval_jitter = milliseconds_of(options.frame_jitter_ms);
  settings.drop_probability = options.drop_share;
  if (options.full_well_electrons > 0) {
    settings.noise = PixelNoise{.full_well_electrons = options.full_well_electrons};
  }
  settings.seed = options.seed;
  const auto panorama = make_panorama(options, calibration);
  if (!panorama) return error_of(panorama);
  return SyntheticCamera::create(settings, std::move(motion), *panorama);
}

Result<std::unique_ptr<SyntheticImu>> make_imu(const SimulationOptions& options,
                                               const ImuCalibration& calibration,
                                               const Motion& motion) {
  SyntheticImuSettings settings;
  settings.R_camera_imu = calibration.R_camera_imu;
  settings.span.from = SensorTime(kClockAtStart - kLead);
  settings.span.to = SensorTime(kClockAtStart + duration_from_seconds(options.duration_s) + kLead);
  settings.gyro_clock.rate_hz = options.gyro_rate_hz;
  settings.accel_clock = {options.accel_rate_hz, std::chrono::microseconds(1300)};
  settings.gyro.noise_density = options.gyro_noise_rad_s;
  settings.gyro.bias = Eigen::Map<const Eigen::Vector3d>(options.gyro_bias_rad_s.data());
  settings.accel.noise_density = options.accel_noise_m_s2;
  settings.seed = options.seed;
  return SyntheticImu::create(settings, motion);
}

// --- what is written --------------------------------------------------------------------------

std::string in_launch_quotes(const std::string& path) {
  std::string quoted = "\"";
  for (const char letter : path) {
    if (letter == '"' || letter == '\\') quoted += '\\';
    quoted += letter;
  }
  return quoted + '"';
}

/// H.264 that is hard to tell from the original, for displacements of 0.1 px are measured in it;
/// where x264 is not installed, what the sink takes for .mkv.
Result<std::unique_ptr<FrameSink>> open_video(const std::filesystem::path& path,
                                              const CameraFormat& format) {
  const SinkFormat sink_format{format.size, format.fps, format.color};
  const std::string pipeline = fmt::format(
      "x264enc pass=qual quantizer=12 speed-preset=superfast bframes=0 vbv-buf-capacity=0 "
      "! matroskamux ! filesink location={}",
      in_launch_quotes(path.string()));
  auto sink = open_sink(pipeline, sink_format, std::nullopt);
  return sink ? std::move(sink) : open_sink(path.string(), sink_format, std::nullopt);
}

Result<void> write_video(SyntheticCamera& camera, const SimulationOptions& options) {
  auto sink = open_video(options.output / "video.mkv", camera.format());
  if (!sink) return error_of(sink);
  if (Result<void> started = camera.start(); !started) return started;
  ProgressBar progress("simulate", static_cast<std::int64_t>(camera.frame_count()),
                       options.quiet ? ProgressStyle::quiet : ProgressStyle::automatic);
  while (true) {
    const Result<std::optional<VideoFrame>> frame = camera.read();
    if (!frame) return error_of(frame);
    if (!*frame) return (*sink)->finish();
    if (Result<void> written = (*sink)->write(**frame); !written) return written;
    progress.advance();
    const bool middle =
        (*frame)->stamp.index == static_cast<std::int64_t>(camera.frame_count()) / 2;
    if (middle) {
      Result<void> still =
          write_still(**frame, options.output / "thumbnail.jpg", kThumbnailWidth_px);
      if (!still) return still;
    }
  }
}

void append_quaternion(fmt::memory_buffer& out, const Eigen::Quaterniond& q) {
  fmt::format_to(std::back_inserter(out), "{:.12f},{:.12f},{:.12f},{:.12f}", q.w(), q.x(), q.y(),
                 q.z());
}

Result<void> write_text(const std::filesystem::path& path, const fmt::memory_buffer& text) {
  std::ofstream file(path, std::ios::binary);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  if (file) return {};
  return failed(fmt::format("{}: cannot be written; is the disk full?", path.string()));
}

/// truth.csv: orientation of the IMU at the gyro's stamps, and whether it moves.
Result<void> write_imu_truth(const SyntheticImu& imu, const Eigen::Matrix3d& R_camera_imu,
                             const Motion& motion, const std::filesystem::path& path) {
  constexpr double kMoving_rad_s = 2.0 * std::numbers::pi / 180.0;
  const Eigen::Quaterniond q_camera_imu(R_camera_imu);
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out), "t_s,qw,qx,qy,qz,movement\n");
  for (const GyroSample& sample : imu.gyro()) {
    const MotionState state = motion.at(sample.time);
    fmt::format_to(std::back_inserter(out), "{},", format_seconds(sample.time.time_since_epoch()));
    append_quaternion(out, state.q_world_camera * q_camera_imu);
    fmt::format_to(std::back_inserter(out), ",{}\n",
                   state.rate_rad_s.norm() > kMoving_rad_s ? 1 : 0);
  }
  return write_text(path, out);
}

/// truth_rows.csv: orientation of the camera in the middle of the exposure of every eighth line and
/// the last, with the time on the IMU's clock.
Result<void> write_row_truth(const SyntheticCamera& camera, const Motion& motion,
                             const std::filesystem::path& path) {
  constexpr int kEvery = 8;
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out), "index,row,t_s,qw,qx,qy,qz\n");
  const int last = camera.line_count() - 1;
  for (std::size_t frame = 0; frame < camera.frame_count(); ++frame) {
    for (int line = 0; line <= last;
         line = line == last ? last + 1 : std::min(line + kEvery, last)) {
      const SensorTime time = camera.time_of_line(frame, line);
      fmt::format_to(std::back_inserter(out), "{},{},{},", frame, line,
                     format_seconds(time.time_since_epoch()));
      append_quaternion(out, motion.at(time).q_world_camera);
      out.push_back('\n');
    }
  }
  return write_text(path, out);
}

Result<void> check(const SimulationOptions& options) {
  const auto within = [](double value, double least, double most) {
    return value >= least && value <= most;  // false for what is not a number
  };
  struct Limit {
    const char* option;
    double value;
    double least;
    double most;
    const char* unit;
  };
  const std::array limits = {
      Limit{"--time-offset", options.time_offset_ms.value_or(0), -1e7, 1e7, "ms"},
      Limit{"--exposure", options.exposure_ms, 0, 1e4, "ms"},
      Limit{"--readout", options.readout_ms.value_or(0), 0, 1e4, "ms"},
      Limit{"--frame-jitter", options.frame_jitter_ms, 0, 1e3, "ms"},
      Limit{"--full-well", options.full_well_electrons, 0, 1e9, "electrons"},
      Limit{"--accel-rate", options.accel_rate_hz, 0, 1e4, "Hz"},
      Limit{"--gyro-noise", options.gyro_noise_rad_s, 0, 10, "rad/s/√Hz"},
      Limit{"--accel-noise", options.accel_noise_m_s2, 0, 100, "m/s²/√Hz"},
      Limit{"--gyro-bias", options.gyro_bias_rad_s[0], -100, 100, "rad/s"},
      Limit{"--gyro-bias", options.gyro_bias_rad_s[1], -100, 100, "rad/s"},
      Limit{"--gyro-bias", options.gyro_bias_rad_s[2], -100, 100, "rad/s"},
  };
  for (const Limit& limit : limits) {
    if (within(limit.value, limit.least, limit.most)) continue;
    return bad_input(fmt::format("{} {}: must lie between {} and {} {}", limit.option, limit.value,
                                 limit.least, limit.most, limit.unit));
  }
  if (!within(options.duration_s, 0.1, 3600)) {
    return bad_input(
        fmt::format("--duration {}: must lie between 0.1 and 3600 s", options.duration_s));
  }
  if (!within(options.start_s, 0, 1e6)) {
    return bad_input(fmt::format("--start {}: must not be negative", options.start_s));
  }
  if (!within(options.drop_share, 0, 0.9)) {
    return bad_input(
        fmt::format("--drop-frames {}: must lie between 0 and 0.9", options.drop_share));
  }
  if (!within(options.gyro_rate_hz, 1, 1e4)) {
    return bad_input(
        fmt::format("--gyro-rate {}: must lie between 1 and 10000 Hz", options.gyro_rate_hz));
  }
  return {};
}

}  // namespace

Result<void> simulate(const SimulationOptions& options) {
  if (Result<void> checked = check(options); !checked) return checked;
  Result<Session> session = load_camera(options);
  if (!session) return error_of(session);
  const Result<Motion> made_motion = make_motion(options);
  if (!made_motion) return error_of(made_motion);
  const auto motion = std::make_shared<const Motion>(*made_motion);
  const auto camera = make_camera(options, *session->camera, motion);
  if (!camera) return error_of(camera);
  const auto imu = make_imu(options, session->imu, *motion);
  if (!imu) return error_of(imu);

  if (Result<void> made = make_session_folder(options.output); !made) return made;
  if (Result<void> written = write_video(**camera, options); !written) return written;
  session->folder = options.output;
  session->video = options.output / "video.mkv";
  session->quality = fmt::format("{}x{}@{:g}", session->camera->size.width,
                                 session->camera->size.height, session->camera->fps);
  for (std::size_t i = 0; i < (*camera)->frame_count(); ++i) {
    session->frames.push_back((*camera)->stamp(i));
  }
  session->gyro = (*imu)->gyro();
  session->accel = (*imu)->accel();
  session->notes = {fmt::format("Simulated by gimbalctl: motion {}, scene {}, seed {}.",
                                options.motion, options.scene, options.seed),
                    "truth.csv: q_world_imu at the gyroscope's stamps.",
                    "truth_rows.csv: q_world_camera in the middle of the exposure of lines."};
  if (Result<void> written = write_session(*session); !written) return written;
  return write_imu_truth(**imu, session->imu.R_camera_imu, *motion, options.output / "truth.csv")
      .and_then(
          [&] { return write_row_truth(**camera, *motion, options.output / "truth_rows.csv"); });
}

}  // namespace gimbal
