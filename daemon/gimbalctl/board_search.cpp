#include "daemon/gimbalctl/board_search.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string_view>
#include <system_error>
#include <utility>

#include "daemon/gimbalctl/stop_request.hpp"
#include "daemon/gimbalctl/warnings.hpp"
#include "drivers/replay/replay_camera.hpp"
#include "drivers/replay/video_probe.hpp"

namespace gimbal {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kViewsEnough = 20;
constexpr SensorDuration kBetweenLooks = std::chrono::milliseconds(200);
constexpr std::int64_t kMostLooks = 600;  // into one video

constexpr std::array<std::string_view, 8> kPhotographs = {".bmp", ".jpeg", ".jpg",  ".pgm",
                                                          ".png", ".tif",  ".tiff", ".webp"};

bool is_photograph(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kPhotographs.begin(), kPhotographs.end(), ending) != kPhotographs.end();
}

Result<PictureFiles> pictures_of_session(const fs::path& folder) {
  auto session = open_session(folder);
  if (!session) return tl::unexpected(session.error());
  print_warnings(session->warnings);
  if (session->video.empty()) return bad_input(folder.string() + ": there is no video");
  PictureFiles pictures;
  pictures.files = {session->video};
  pictures.session = std::move(*session);
  return pictures;
}

Result<PictureFiles> pictures_in_folder(const fs::path& folder) {
  PictureFiles pictures;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (is_photograph(entry->path())) pictures.files.push_back(entry->path());
  }
  if (error) return bad_input(folder.string() + ": " + error.message());
  if (pictures.files.empty()) {
    return bad_input(fmt::format("{}: there are no pictures ({}) and no session.toml",
                                 folder.string(), fmt::join(kPhotographs, ", ")));
  }
  std::sort(pictures.files.begin(), pictures.files.end());
  pictures.pictures = ViewChoice::Pictures::chosen;
  return pictures;
}

/// Stamps by which every picture of a file is read, whatever its own times.
Result<std::vector<FrameStamp>> stamps_of(const fs::path& file) {
  const auto info = probe_video(file);
  if (!info) return tl::unexpected(info.error());
  const double step_s = info->fps > 0 ? 1 / info->fps : 1.0 / 30;
  std::vector<FrameStamp> stamps;
  for (std::int64_t i = 0; i < std::max<std::int64_t>(1, info->frame_count); ++i) {
    stamps.push_back({i, SensorTime(duration_from_seconds(static_cast<double>(i) * step_s)), {}});
  }
  return stamps;
}

SensorDuration between_looks(const std::vector<FrameStamp>& stamps) {
  return std::max(kBetweenLooks, (stamps.back().time - stamps.front().time) / kMostLooks);
}

Result<void> search_file(const fs::path& file, const std::vector<FrameStamp>& stamps,
                         BoardSearch& search, ProgressBar& bar) {
  if (stamps.empty()) return {};
  ReplayCamera camera(file, stamps, 0);
  if (auto started = camera.start(); !started) return started;
  const SensorDuration step = between_looks(stamps);
  std::optional<SensorTime> next;
  while (true) {
    const auto frame = camera.read();
    if (!frame) return tl::unexpected(frame.error());
    if (!*frame) return {};
    bar.advance();
    const FrameStamp& stamp = (*frame)->stamp;
    if (next && stamp.time < *next) continue;
    next = stamp.time + step;
    const std::string name = file.filename().string();
    const auto kept = search.look(
        **frame, stamps.size() == 1 ? name : fmt::format("{}, picture {}", name, stamp.index));
    if (!kept) return bad_input(file.string() + ": " + kept.error().message);
  }
}

void say_what_is_missing(const BoardSearch& search) {
  const auto missing = coverage_of(search.views(), search.size()).missing();
  const std::string line =
      fmt::format("{} views; {}\n", search.views().size(),
                  missing.empty() ? "some more, please"
                                  : fmt::format("still missing: {}", fmt::join(missing, ", ")));
  static_cast<void>(std::fputs(line.c_str(), stderr));
}

}  // namespace

Result<bool> BoardSearch::look(const VideoFrame& frame, const std::string& name) {
  if (!choice_) {
    size_ = frame.size;
    choice_.emplace(size_, pictures_);
  }
  if (frame.size != size_) {
    return bad_input(
        fmt::format("is {}x{}, but those before are {}x{}; all must be of one camera in one mode",
                    frame.size.width, frame.size.height, size_.width, size_.height));
  }
  ++looked_;
  auto view = detector_->find(frame);
  if (!view) return false;
  view->name = name;
  return choice_->offer(std::move(*view));
}

const std::vector<BoardView>& BoardSearch::views() const {
  static const std::vector<BoardView> none;
  return choice_ ? choice_->views() : none;
}

bool BoardSearch::is_complete() const {
  return views().size() >= kViewsEnough && coverage_of(views(), size_).missing().empty();
}

Result<PictureFiles> find_pictures(std::span<const fs::path> sources) {
  std::error_code ignored;
  if (sources.size() == 1 && fs::is_directory(sources[0], ignored)) {
    const bool is_session = fs::exists(sources[0] / "session.toml", ignored);
    return is_session ? pictures_of_session(sources[0]) : pictures_in_folder(sources[0]);
  }
  PictureFiles pictures;
  pictures.files.assign(sources.begin(), sources.end());
  if (std::all_of(sources.begin(), sources.end(), is_photograph)) {
    pictures.pictures = ViewChoice::Pictures::chosen;
  }
  return pictures;
}

Result<void> search_files(const PictureFiles& pictures, BoardSearch& search,
                          ProgressStyle progress) {
  std::vector<std::vector<FrameStamp>> stamps;
  std::size_t count = 0;
  for (const fs::path& file : pictures.files) {
    auto found = pictures.session ? Result<std::vector<FrameStamp>>(pictures.session->frames)
                                  : stamps_of(file);
    if (!found) return tl::unexpected(found.error());
    count += found->size();
    stamps.push_back(std::move(*found));
  }
  ProgressBar bar("look", static_cast<std::int64_t>(count), progress);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (auto searched = search_file(pictures.files[i], stamps[i], search, bar); !searched) {
      return searched;
    }
  }
  return {};
}

Result<void> search_camera(CameraSource& camera, BoardSearch& search, double longest_s,
                           ProgressStyle progress) {
  const StopRequest stop;
  if (auto started = camera.start(); !started) return started;
  std::optional<SensorTime> first;
  SensorTime next{};
  while (!stop.came() && !search.is_complete()) {
    const auto frame = camera.read();
    if (!frame) return tl::unexpected(frame.error());
    if (!*frame) break;
    const SensorTime time = (*frame)->stamp.time;
    if (!first) first = next = time;
    if (to_seconds(time - *first) > longest_s) break;
    if (time < next) continue;
    next = time + kBetweenLooks;
    const auto kept = search.look(**frame, fmt::format("{:.1f} s", to_seconds(time - *first)));
    if (!kept) return tl::unexpected(kept.error());
    if (*kept && progress == ProgressStyle::automatic) say_what_is_missing(search);
  }
  camera.stop();
  return {};
}

}  // namespace gimbal
