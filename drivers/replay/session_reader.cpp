#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <system_error>
#include <utility>

#include "drivers/replay/session.hpp"
#include "drivers/replay/session_checks.hpp"
#include "drivers/replay/session_toml.hpp"

namespace gimbal {

namespace {

constexpr std::array<std::string_view, 3> kVideoNames{"video.mkv", "video.mp4", "video.mov"};

bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

void find_video(Session& session) {
  for (const std::string_view name : kVideoNames) {
    const std::filesystem::path candidate = session.folder / name;
    if (!is_there(candidate)) continue;
    if (session.video.empty()) {
      session.video = candidate;
    } else {
      session.warnings.push_back(fmt::format("{} is passed over: {} is there too", name,
                                             session.video.filename().string()));
    }
  }
}

/// Nothing, if the file is not there.
Result<GyroLog> read_gyro(const Session& session, std::vector<std::string>& warnings) {
  const std::filesystem::path path = session.folder / "gyro.csv";
  if (!is_there(path)) return GyroLog{};
  Result<GyroLog> log = read_gyro_csv(path, warnings);
  if (!log) return log;
  if (Result<void> usable = check_has_samples(*log); !usable) return tl::unexpected(usable.error());
  return log;
}

/// The accelerometer is a help, not a must: a log without samples is as good as none.
Result<AccelLog> read_accel(const Session& session, double to_specific_force_m_s2,
                            std::vector<std::string>& warnings) {
  const std::filesystem::path path = session.folder / "accel.csv";
  std::error_code ignored;
  if (!is_there(path)) return AccelLog{};
  const bool is_empty = std::filesystem::file_size(path, ignored) == 0;
  Result<AccelLog> log = is_empty ? Result<AccelLog>(AccelLog{})
                                  : read_accel_csv(path, to_specific_force_m_s2, warnings);
  if (log && log->samples.empty()) {
    warnings.emplace_back("accel.csv: no usable sample; taken as if there were no accelerometer");
  }
  return log;
}

/// Nothing, if there is neither a file nor a video that needs it.
Result<FrameLog> read_frames(const Session& session, std::vector<std::string>& warnings) {
  const std::filesystem::path path = session.folder / "frames.csv";
  if (!is_there(path) && session.video.empty()) return FrameLog{};
  if (!is_there(path)) {
    return bad_input(fmt::format("{}: no such file; a video's own stamps are not trusted, so there "
                                 "must be a line index,t_s for each picture",
                                 path.string()));
  }
  Result<FrameLog> log = read_frames_csv(path, warnings);
  if (!log) return log;
  if (Result<void> usable = check_has_samples(*log); !usable) return tl::unexpected(usable.error());
  return log;
}

Result<SessionLogs> read_logs(const Session& session, double accel_factor,
                              std::vector<std::string>& warnings) {
  Result<GyroLog> gyro = read_gyro(session, warnings);
  if (!gyro) return tl::unexpected(gyro.error());
  Result<AccelLog> accel = read_accel(session, accel_factor, warnings);
  if (!accel) return tl::unexpected(accel.error());
  Result<FrameLog> frames = read_frames(session, warnings);
  if (!frames) return tl::unexpected(frames.error());
  return SessionLogs{std::move(*gyro), std::move(*accel), std::move(*frames)};
}

void report_missing_video(Session& session) {
  if (!session.video.empty() || session.frames.empty()) return;
  session.warnings.emplace_back("no video.mkv, video.mp4 or video.mov: there is nothing to draw");
}

Result<Session> open_session_folder(const std::filesystem::path& folder) {
  const std::filesystem::path toml = folder / "session.toml";
  if (!is_there(toml)) {
    return bad_input(fmt::format("{}: no session.toml in it; if it is a recording of another kind, "
                                 "gimbalctl sessions import {} -o SESSION",
                                 folder.string(), folder.string()));
  }
  Result<SessionToml> description = read_session_toml(toml);
  if (!description) return tl::unexpected(description.error());
  Session session = std::move(description->session);
  session.folder = folder;
  session.warnings = std::move(description->warnings);
  find_video(session);
  Result<SessionLogs> logs =
      read_logs(session, description->accel_to_specific_force_m_s2, session.warnings);
  if (!logs) return tl::unexpected(logs.error());
  if (Result<void> adopted = adopt_logs(std::move(*logs), session); !adopted) {
    return tl::unexpected(adopted.error());
  }
  report_missing_video(session);
  return session;
}

}  // namespace

Result<Session> open_session(const std::filesystem::path& path) {
  if (!is_there(path)) return bad_input(fmt::format("{}: no such session", path.string()));
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return open_session_folder(path);
  return bad_input(fmt::format("{}: not a session folder", path.string()));
}

}  // namespace gimbal
