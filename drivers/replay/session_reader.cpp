#include <fmt/core.h>

#include <system_error>
#include <utility>

#include "drivers/replay/gcsv.hpp"
#include "drivers/replay/session.hpp"
#include "drivers/replay/session_logs.hpp"
#include "drivers/replay/session_toml.hpp"

namespace gimbal {

namespace {

bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

/// Pictures need times and times need pictures.
Result<void> check_video_has_times(Session& session) {
  if (session.video.empty() && !session.frames.empty()) {
    session.warnings.emplace_back("no video.mkv, video.mp4 or video.mov: there is nothing to draw");
  }
  if (session.video.empty() || !session.frames.empty()) return {};
  return bad_input(
      fmt::format("{}: no such file; a video's own stamps are not trusted, so there "
                  "must be a line index,t_s for each picture",
                  (session.folder / "frames.csv").string()));
}

Result<Session> open_session_folder(const std::filesystem::path& folder) {
  const std::filesystem::path toml = folder / "session.toml";
  if (!is_there(toml)) {
    return bad_input(
        fmt::format("{}: no session.toml in it; if it is a recording of another kind, "
                    "gimbalctl sessions import {} -o SESSION",
                    folder.string(), folder.string()));
  }
  Result<SessionToml> description = read_session_toml(toml);
  if (!description) return tl::unexpected(description.error());
  Session session = std::move(description->session);
  session.folder = folder;
  session.warnings = std::move(description->warnings);
  session.video = find_session_video(folder, session.warnings);
  Result<SessionLogs> logs =
      read_session_logs(folder, description->accel_to_specific_force_m_s2, session.warnings);
  if (!logs) return tl::unexpected(logs.error());
  if (Result<void> adopted = adopt_logs(std::move(*logs), session); !adopted) {
    return tl::unexpected(adopted.error());
  }
  if (Result<void> paired = check_video_has_times(session); !paired) {
    return tl::unexpected(paired.error());
  }
  return session;
}

Result<Session> open_gyroflow_recording(const std::filesystem::path& video,
                                        const std::filesystem::path& log) {
  Result<std::pair<Session, SessionLogs>> recording = read_gyroflow_recording(video, log);
  if (!recording) return tl::unexpected(recording.error());
  auto& [session, logs] = *recording;
  if (Result<void> adopted = adopt_logs(std::move(logs), session); !adopted) {
    return tl::unexpected(adopted.error());
  }
  return std::move(session);
}

}  // namespace

Result<Session> open_session(const std::filesystem::path& path) {
  if (!is_there(path)) return bad_input(fmt::format("{}: no such session", path.string()));
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return open_session_folder(path);
  const std::filesystem::path log = gcsv_beside(path);
  if (!log.empty() && log != path) return open_gyroflow_recording(path, log);
  return bad_input(fmt::format(
      "{}: neither a session folder nor a video with a Gyroflow log (.gcsv) beside it; gimbalctl "
      "sessions import reads other recordings",
      path.string()));
}

}  // namespace gimbal
