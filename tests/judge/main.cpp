// Measures how steady a video is by its pictures alone, whoever stabilized it: nothing is known of
// how it was made. Prints JSON; what the figures mean is said in video_judge.hpp.
//
//   video_judge VIDEO [--original VIDEO] [--focal PX] [--fps FPS]
//
// --original  what VIDEO was made of, frame by frame: tells zoom, retained view and distortion
// --focal     focal length of the original (or of VIDEO, without one), px; else the picture's
// width,
//             as of a view 53° wide
// --fps       frames a second; else what the file says

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "drivers/replay/replay_camera.hpp"
#include "drivers/replay/video_probe.hpp"
#include "tests/judge/video_judge.hpp"

namespace gimbal::judge {
namespace {

struct Request {
  std::filesystem::path video;
  std::filesystem::path original;  ///< empty: none
  double focal_px = 0;             ///< 0: as wide as the picture
  double fps = 0;                  ///< 0: the file's
};

/// The luma of a file's pictures, in order.
class LumaReader {
 public:
  [[nodiscard]] static Result<LumaReader> open(const std::filesystem::path& file) {
    auto info = probe_video(file);
    if (!info) return tl::unexpected(info.error());
    std::vector<FrameStamp> stamps;
    for (std::int64_t i = 0; i < info->frame_count; ++i) stamps.push_back({i, {}, std::nullopt});
    LumaReader reader;
    reader.info_ = *std::move(info);
    reader.camera_ = std::make_unique<ReplayCamera>(file, std::move(stamps), reader.info_.fps);
    if (auto started = reader.camera_->start(); !started) return tl::unexpected(started.error());
    return reader;
  }

  [[nodiscard]] const VideoInfo& info() const { return info_; }

  [[nodiscard]] Result<std::optional<cv::Mat>> next() {
    auto frame = camera_->read();
    if (!frame) return tl::unexpected(frame.error());
    if (!*frame) return std::optional<cv::Mat>{};
    const VideoFrame& picture = **frame;
    return cv::Mat(picture.size.height, picture.size.width, CV_8UC1,
                   const_cast<std::uint8_t*>(picture.planes[0].data),
                   static_cast<std::size_t>(picture.planes[0].stride_bytes))
        .clone();
  }

 private:
  VideoInfo info_;
  std::unique_ptr<ReplayCamera> camera_;
};

Result<std::optional<LumaReader>> open_original(const Request& request, const VideoInfo& video) {
  if (request.original.empty()) return std::optional<LumaReader>{};
  auto reader = LumaReader::open(request.original);
  if (!reader) return tl::unexpected(reader.error());
  if (reader->info().size == video.size && reader->info().frame_count == video.frame_count) {
    return std::optional(*std::move(reader));
  }
  return bad_input(fmt::format(
      "{}: {} frames of {}x{}, but the original has {} of {}x{}: every frame is compared with its "
      "own",
      request.video.string(), video.frame_count, video.size.width, video.size.height,
      reader->info().frame_count, reader->info().size.width, reader->info().size.height));
}

Result<Judgement> judge(const Request& request) {
  auto video = LumaReader::open(request.video);
  if (!video) return tl::unexpected(video.error());
  auto original = open_original(request, video->info());
  if (!original) return tl::unexpected(original.error());
  const double fps = request.fps > 0 ? request.fps : video->info().fps;
  if (fps <= 0) return bad_input(request.video.string() + ": tells no frame rate; give --fps");
  VideoJudge judge(request.focal_px > 0 ? request.focal_px : video->info().size.width, fps);
  while (true) {
    const auto luma = video->next();
    if (!luma) return tl::unexpected(luma.error());
    if (!*luma) return judge.judgement();
    std::optional<cv::Mat> original_luma;
    if (*original) {
      auto next = (*original)->next();
      if (!next) return tl::unexpected(next.error());
      original_luma = *std::move(next);
    }
    judge.add(**luma, original_luma);
  }
}

nlohmann::ordered_json to_json(const std::vector<Measured>& path_deg) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const auto& [time_s, turn] : path_deg) json.push_back({time_s, turn[0], turn[1], turn[2]});
  return json;
}

nlohmann::ordered_json to_json(const Judgement& judgement) {
  nlohmann::ordered_json json = {{"frames", judgement.frames},
                                 {"lost_pairs", judgement.lost_pairs},
                                 {"rate_above_1hz_deg_s", judgement.rate_deg_s},
                                 {"rate_inside_above_1hz_deg_s", nullptr},
                                 {"shift_above_1hz_px", judgement.shift_px},
                                 {"wobble_px", judgement.wobble_px},
                                 {"residual_px", judgement.residual_px},
                                 {"itf_db", judgement.itf_db},
                                 {"border_share", judgement.border_share},
                                 {"worst_border_share", judgement.worst_border_share},
                                 {"path_deg", to_json(judgement.path_deg)}};
  if (judgement.rate_inside_deg_s) {
    json["rate_inside_above_1hz_deg_s"] = *judgement.rate_inside_deg_s;
  }
  if (const auto& view = judgement.against_original) {
    json["against_original"] = {{"frames", view->frames},
                                {"zoom", view->zoom},
                                {"retained_view", view->retained_view},
                                {"distortion", view->distortion},
                                {"worst_distortion", view->worst_distortion}};
  }
  return json;
}

int run(const Request& request) {
  const Result<Judgement> judgement = judge(request);
  if (!judgement) {
    fmt::print(stderr, "video_judge: {}\n", judgement.error().message);
    return judgement.error().kind == Error::Kind::bad_input ? 2 : 1;
  }
  fmt::print("{}\n", to_json(*judgement).dump());
  return 0;
}

}  // namespace
}  // namespace gimbal::judge

int main(int argc, char** argv) {
  gimbal::judge::Request request;
  CLI::App app("Measures how steady a video is by its pictures alone");
  app.add_option("video", request.video)->required();
  app.add_option("--original", request.original, "What the video was made of");
  app.add_option("--focal", request.focal_px, "Of the original, px")->check(CLI::PositiveNumber);
  app.add_option("--fps", request.fps, "Frames a second")->check(CLI::PositiveNumber);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return gimbal::judge::run(request);
}
