#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "drivers/replay/import/importer.hpp"
#include "drivers/replay/import/mp4.hpp"
#include "drivers/replay/replay_camera.hpp"
#include "drivers/replay/still.hpp"

namespace gimbal {

namespace {

Result<Session> read_recording(const std::filesystem::path& input) {
  std::error_code ignored;
  if (!std::filesystem::exists(input, ignored)) {
    return bad_input(fmt::format("{}: no such file or folder", input.string()));
  }
  const auto importer =
      std::find_if(importers().begin(), importers().end(),
                   [&](const Importer& candidate) { return candidate.recognises(input); });
  if (importer != importers().end()) return importer->read(input);
  if (std::filesystem::is_regular_file(input / "session.toml", ignored)) {
    return bad_input(fmt::format("{}: is a session already", input.string()));
  }
  if (looks_like_mp4(input)) {  // cut off in copying, perhaps
    if (const auto tracks = read_mp4_tracks(input); !tracks) return tl::unexpected(tracks.error());
  }
  std::vector<std::string_view> kinds;
  for (const Importer& known : importers()) kinds.push_back(known.kind);
  return bad_input(fmt::format("{}: not a recording of a known kind ({})", input.string(),
                               fmt::join(kinds, "; ")));
}

/// What the recording says of its stamps and its readout stays where the lens says nothing of it.
Result<void> take_lens(const LensFile& lens, Session& session) {
  CameraCalibration camera;
  if (session.camera_without_lens) camera = *session.camera_without_lens;
  if (session.camera) camera = *session.camera;
  auto fitted = camera.size.width > 0 ? fitted_to(lens.camera, camera.size) : lens.camera;
  if (!fitted) return tl::unexpected(fitted.error());
  camera.size = fitted->size;
  camera.lens = fitted->lens;
  if (camera.readout == SensorDuration::zero()) camera.readout = fitted->readout;
  if (camera.time_offset == SensorDuration::zero()) camera.time_offset = fitted->time_offset;
  if (camera.fps == 0) camera.fps = fitted->fps;
  if (lens.R_camera_imu) session.imu.R_camera_imu = *lens.R_camera_imu;
  session.camera = camera;
  session.camera_without_lens.reset();
  return {};
}

/// Takes away what an import wrote into a folder that was empty before.
void clear(const std::filesystem::path& folder) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    std::filesystem::remove(entry.path(), error);
  }
}

/// The first picture, small. A video that cannot be decoded makes no session unusable.
void write_thumbnail(Session& session) {
  constexpr int kWidth_px = 320;
  if (session.video.empty() || session.frames.empty()) return;
  ReplayCamera camera(session.video, {session.frames.front()}, 0);
  const Result<void> written =
      camera.start()
          .and_then([&] { return camera.read(); })
          .and_then([&](const std::optional<VideoFrame>& frame) -> Result<void> {
            if (!frame) return bad_input("there is no picture");
            return write_still(*frame, session.folder / "thumbnail.jpg", kWidth_px);
          });
  if (written) return;
  session.warnings.push_back(fmt::format("no thumbnail: {}", written.error().message));
}

}  // namespace

std::span<const Importer> importers() {
  static const std::array kImporters{kMetaJsonImporter, kIosLoggerImporter, kCoreMotionLogImporter,
                                     kGyroflowImporter, kGoProImporter,     kAndroidLogImporter};
  return kImporters;
}

Result<Session> import_session(const std::filesystem::path& input,
                               const std::filesystem::path& folder,
                               const std::optional<LensFile>& lens) {
  Result<Session> session = read_recording(input);
  if (!session) return session;
  if (lens) {
    if (auto taken = take_lens(*lens, *session); !taken) return tl::unexpected(taken.error());
  }
  if (Result<void> made = make_session_folder(folder); !made) return tl::unexpected(made.error());
  session->folder = folder;
  Result<Session> opened = write_session(*session).and_then([&] { return open_session(folder); });
  if (!opened) {
    clear(folder);
    return bad_input(fmt::format("{}: does not make a sound session: {}", input.string(),
                                 opened.error().message));
  }
  write_thumbnail(*opened);
  opened->warnings.insert(opened->warnings.begin(), session->warnings.begin(),
                          session->warnings.end());
  return opened;
}

}  // namespace gimbal
