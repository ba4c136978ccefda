#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>

#include "drivers/replay/session.hpp"
#include "drivers/replay/session_rows.hpp"
#include "drivers/replay/session_toml.hpp"

namespace gimbal {

namespace {

Result<void> write_text(const std::filesystem::path& path, std::string_view text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) {
    return failed(fmt::format("{}: cannot be written ({})", path.string(), std::strerror(errno)));
  }
  return {};
}

template <typename Sample>
std::string format_vectors(const std::vector<Sample>& samples) {
  std::string text = kVectorHeader;
  for (const Sample& sample : samples) text += session_row(sample);
  return text;
}

std::string format_frames(const std::vector<FrameStamp>& frames) {
  const bool any_exposure = std::any_of(frames.begin(), frames.end(), [](const FrameStamp& stamp) {
    return stamp.exposure.has_value();
  });
  std::string text = any_exposure ? kFrameHeader : kFrameHeaderWithoutExposure;
  for (const FrameStamp& stamp : frames) {
    text += any_exposure ? session_row(stamp) : session_row_without_exposure(stamp);
  }
  return text;
}

/// The name in a session folder: the three that a session may have, Matroska for all else.
std::string_view video_name(const std::filesystem::path& video) {
  std::string extension = video.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  if (extension == ".mp4" || extension == ".m4v") return "video.mp4";
  if (extension == ".mov") return "video.mov";
  return "video.mkv";
}

Result<void> copy_video(const Session& session) {
  if (session.video.empty()) return {};
  std::error_code error;
  if (std::filesystem::equivalent(session.video.parent_path(), session.folder, error)) return {};
  const std::filesystem::path target = session.folder / video_name(session.video);
  std::filesystem::copy_file(session.video, target,
                             std::filesystem::copy_options::overwrite_existing, error);
  if (!error) {
    // A recording on a read-only medium must not make a session that its owner cannot delete.
    std::filesystem::permissions(target, std::filesystem::perms::owner_write,
                                 std::filesystem::perm_options::add, error);
    return {};
  }
  return failed(fmt::format("{}: cannot be copied to {} ({})", session.video.string(),
                            target.string(), error.message()));
}

}  // namespace

Result<void> make_session_folder(const std::filesystem::path& folder) {
  std::error_code error;
  if (std::filesystem::exists(folder, error) &&
      !(std::filesystem::is_directory(folder, error) && std::filesystem::is_empty(folder, error))) {
    return bad_input(fmt::format(
        "{}: exists already; name a new folder or an empty one for the session", folder.string()));
  }
  std::filesystem::create_directories(folder, error);
  if (!error) return {};
  return bad_input(fmt::format("{}: cannot be made ({})", folder.string(), error.message()));
}

Result<void> write_session(const Session& session) {
  std::error_code error;
  std::filesystem::create_directories(session.folder, error);
  if (error) {
    return bad_input(
        fmt::format("{}: cannot be made ({})", session.folder.string(), error.message()));
  }
  return copy_video(session)
      .and_then(
          [&] { return write_text(session.folder / "session.toml", format_session_toml(session)); })
      .and_then([&]() -> Result<void> {
        if (session.frames.empty()) return {};
        return write_text(session.folder / "frames.csv", format_frames(session.frames));
      })
      .and_then([&]() -> Result<void> {
        if (session.gyro.empty()) return {};
        return write_text(session.folder / "gyro.csv", format_vectors(session.gyro));
      })
      .and_then([&]() -> Result<void> {
        if (session.accel.empty()) return {};
        return write_text(session.folder / "accel.csv", format_vectors(session.accel));
      });
}

}  // namespace gimbal
