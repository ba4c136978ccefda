#include "drivers/replay/session_logs.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <utility>

namespace gimbal {

namespace {

constexpr std::array<std::string_view, 3> kVideoNames{"video.mkv", "video.mp4", "video.mov"};
constexpr double kImuGapInMedians = 5.0;
constexpr double kFrameGapInMedians = 1.4;

bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

Result<GyroLog> read_gyro(const std::filesystem::path& path, std::vector<std::string>& warnings) {
  if (!is_there(path)) return GyroLog{};
  Result<GyroLog> log = read_gyro_csv(path, warnings);
  if (!log) return log;
  if (Result<void> usable = check_has_samples(*log); !usable) return tl::unexpected(usable.error());
  return log;
}

/// The accelerometer is a help, not a must.
Result<AccelLog> read_accel(const std::filesystem::path& path, double to_specific_force_m_s2,
                            std::vector<std::string>& warnings) {
  if (!is_there(path)) return AccelLog{};
  std::error_code ignored;
  const bool is_empty = std::filesystem::file_size(path, ignored) == 0;
  Result<AccelLog> log = is_empty ? Result<AccelLog>(AccelLog{})
                                  : read_accel_csv(path, to_specific_force_m_s2, warnings);
  if (log && log->samples.empty()) {
    warnings.emplace_back("accel.csv: no usable sample; taken as if there were no accelerometer");
  }
  return log;
}

Result<FrameLog> read_frames(const std::filesystem::path& path,
                             std::vector<std::string>& warnings) {
  if (!is_there(path)) return FrameLog{};
  Result<FrameLog> log = read_frames_csv(path, warnings);
  if (!log) return log;
  if (Result<void> usable = check_has_samples(*log); !usable) return tl::unexpected(usable.error());
  return log;
}

struct TimeRange {
  SensorTime first;
  SensorTime last;
};

template <typename Sample>
TimeRange range_of(const std::vector<Sample>& samples) {
  return {samples.front().time, samples.back().time};
}

std::string as_text(TimeRange range) {
  return fmt::format("{:.3f} to {:.3f} s", seconds_since_epoch(range.first),
                     seconds_since_epoch(range.last));
}

template <typename Sample>
Result<void> prepare(StampedLog<Sample>& log, PlausibleStep plausible, double gap_in_medians,
                     std::vector<std::string>& warnings) {
  keep_rising_stamps(log, warnings);
  if (Result<void> seconds = check_stamps_are_seconds(log, plausible); !seconds) return seconds;
  report_gaps(log, gap_in_medians, warnings);
  return {};
}

SensorDuration time_offset_of(const Session& session) {
  if (session.camera) return session.camera->time_offset;
  return session.camera_without_lens ? session.camera_without_lens->time_offset : SensorDuration{};
}

/// When the frames were exposed, on the IMU's clock: their stamps moved by the time offset, and the
/// readout of the last one.
TimeRange exposure_range(const Session& session) {
  const auto& camera = session.camera ? session.camera : session.camera_without_lens;
  const SensorDuration readout = camera ? camera->readout : SensorDuration{};
  const TimeRange stamps = range_of(session.frames);
  return {stamps.first + time_offset_of(session), stamps.last + time_offset_of(session) + readout};
}

/// By way of doubles, since a wrong time offset can make the difference too long for an int64.
double seconds_between(SensorTime from, SensorTime to) {
  return seconds_since_epoch(to) - seconds_since_epoch(from);
}

std::int64_t count_frames_outside(const Session& session, TimeRange gyro) {
  const SensorDuration offset = time_offset_of(session);
  return std::count_if(session.frames.begin(), session.frames.end(), [&](const FrameStamp& stamp) {
    return stamp.time + offset < gyro.first || stamp.time + offset > gyro.last;
  });
}

Result<void> check_gyro_covers_frames(Session& session) {
  const TimeRange gyro = range_of(session.gyro);
  const TimeRange frames = exposure_range(session);
  if (gyro.last < frames.first || gyro.first > frames.last) {
    return bad_input(fmt::format(
        "{}: gyro ({}) and frames ({}) have no time in common; are both on one clock, and is "
        "camera.time_offset_s right?",
        session.folder.string(), as_text(gyro), as_text(frames)));
  }
  const double late_s = seconds_between(frames.first, gyro.first);
  const double early_s = seconds_between(gyro.last, frames.last);
  const std::int64_t outside = count_frames_outside(session, gyro);
  if (late_s > 0) {
    session.warnings.push_back(fmt::format("gyro starts {:.3f} s after the first frame", late_s));
  }
  if (early_s > 0) {
    session.warnings.push_back(
        fmt::format("gyro ends {:.3f} s before the last frame's readout does", early_s));
  }
  if (outside > 0) {
    session.warnings.push_back(fmt::format(
        "{} of {} frames were taken while there was no gyro: their orientation is a guess", outside,
        session.frames.size()));
  }
  return {};
}

void check_accel_covers_gyro(Session& session) {
  const TimeRange gyro = range_of(session.gyro);
  const TimeRange accel = range_of(session.accel);
  constexpr double kWorthSaying_s = 0.1;
  const double late_s = to_seconds(accel.first - gyro.first);
  const double early_s = to_seconds(gyro.last - accel.last);
  if (late_s > kWorthSaying_s) {
    session.warnings.push_back(fmt::format("accelerometer starts {:.3f} s after the gyro", late_s));
  }
  if (early_s > kWorthSaying_s) {
    session.warnings.push_back(fmt::format("accelerometer ends {:.3f} s before the gyro", early_s));
  }
}

double median_magnitude_m_s2(const std::vector<AccelSample>& accel) {
  std::vector<double> magnitudes;
  magnitudes.reserve(accel.size());
  for (const AccelSample& sample : accel) magnitudes.push_back(sample.accel_m_s2.norm());
  const auto middle = magnitudes.begin() + std::ssize(magnitudes) / 2;
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return *middle;
}

/// Whoever holds a camera feels gravity most of the time: other magnitudes are another unit.
void check_accel_unit(const std::string& file, Session& session) {
  const double magnitude = median_magnitude_m_s2(session.accel);
  if (magnitude > 5 && magnitude < 20) return;
  session.warnings.push_back(fmt::format(
      "{}: median acceleration is {:.3g} m/s2 where gravity has 9.81; is its unit given rightly?",
      file, magnitude));
}

void check_gyro_unit(const std::string& file, Session& session) {
  constexpr double kFastest_rad_s = 100;  // chips end at 4000 deg/s = 70 rad/s
  const bool too_fast =
      std::any_of(session.gyro.begin(), session.gyro.end(), [](const GyroSample& sample) {
        return sample.gyro_rad_s.cwiseAbs().maxCoeff() > kFastest_rad_s;
      });
  if (!too_fast) return;
  session.warnings.push_back(
      fmt::format("{}: rates above {} rad/s, faster than gyros measure; are they in deg/s?", file,
                  kFastest_rad_s));
}

Result<void> adopt_gyro(GyroLog log, Session& session) {
  if (log.samples.empty()) {
    session.warnings.emplace_back("no gyro.csv: only plain pass-through is possible");
    return {};
  }
  Result<void> prepared = prepare(log, kPlausibleImuStep, kImuGapInMedians, session.warnings);
  if (!prepared) return prepared;
  if (log.samples.size() < 2) {
    return bad_input(
        fmt::format("{}: only one usable sample, at least two are needed", log.file.string()));
  }
  session.gyro = std::move(log.samples);
  check_gyro_unit(log.file.filename().string(), session);
  return {};
}

Result<void> adopt_accel(AccelLog log, Session& session) {
  if (log.samples.empty()) return {};
  Result<void> prepared = prepare(log, kPlausibleImuStep, kImuGapInMedians, session.warnings);
  if (!prepared) return prepared;
  session.accel = std::move(log.samples);
  check_accel_unit(log.file.filename().string(), session);
  if (!session.gyro.empty()) check_accel_covers_gyro(session);
  return {};
}

/// A picture's place in the video has to rise with its stamp.
Result<void> check_indices_rise(const FrameLog& log) {
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const std::int64_t index = log.samples[i].index;
    if (index >= 0 && (i == 0 || index > log.samples[i - 1].index)) continue;
    return bad_input(
        fmt::format("{}, line {}: index {} does not rise; it is the picture's place in the video, "
                    "from 0",
                    log.file.string(), log.lines[i], index));
  }
  return {};
}

Result<void> adopt_frames(FrameLog log, Session& session) {
  if (log.samples.empty()) return {};
  if (Result<void> rising = check_indices_rise(log); !rising) return rising;
  Result<void> prepared = prepare(log, kPlausibleFrameStep, kFrameGapInMedians, session.warnings);
  if (!prepared) return prepared;
  session.frames = std::move(log.samples);
  if (!session.gyro.empty()) return check_gyro_covers_frames(session);
  return {};
}

}  // namespace

Result<SessionLogs> read_session_logs(const std::filesystem::path& folder,
                                      double accel_to_specific_force_m_s2,
                                      std::vector<std::string>& warnings) {
  Result<GyroLog> gyro = read_gyro(folder / "gyro.csv", warnings);
  if (!gyro) return tl::unexpected(gyro.error());
  Result<AccelLog> accel = read_accel(folder / "accel.csv", accel_to_specific_force_m_s2, warnings);
  if (!accel) return tl::unexpected(accel.error());
  Result<FrameLog> frames = read_frames(folder / "frames.csv", warnings);
  if (!frames) return tl::unexpected(frames.error());
  return SessionLogs{std::move(*gyro), std::move(*accel), std::move(*frames)};
}

std::filesystem::path find_session_video(const std::filesystem::path& folder,
                                         std::vector<std::string>& warnings) {
  std::filesystem::path video;
  for (const std::string_view name : kVideoNames) {
    if (!is_there(folder / name)) continue;
    if (video.empty()) {
      video = folder / name;
    } else {
      warnings.push_back(
          fmt::format("{} is passed over: {} is there too", name, video.filename().string()));
    }
  }
  return video;
}

Result<void> adopt_logs(SessionLogs logs, Session& session) {
  if (Result<void> gyro = adopt_gyro(std::move(logs.gyro), session); !gyro) return gyro;
  if (Result<void> accel = adopt_accel(std::move(logs.accel), session); !accel) return accel;
  return adopt_frames(std::move(logs.frames), session);
}

}  // namespace gimbal
