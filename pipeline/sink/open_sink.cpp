#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "pipeline/gstreamer/gst_runtime.hpp"
#include "pipeline/sink/audio_branch.hpp"
#include "pipeline/sink/frame_sink.hpp"
#include "pipeline/sink/gstreamer_sink.hpp"
#include "pipeline/sink/video_file.hpp"
#include "pipeline/sink/y4m_sink.hpp"

namespace gimbal {
namespace {

Result<std::unique_ptr<FrameSink>> open_pipeline(const std::string& text, const SinkFormat& format,
                                                 std::vector<std::string> warnings) {
  auto pipeline =
      parse_pipeline(fmt::format("appsrc name={} ! videoconvert ! {}", kFrameSourceName, text));
  if (!pipeline) {
    return tl::unexpected(pipeline.error());
  }
  SinkPipeline target;
  target.pipeline = *std::move(pipeline);
  target.warnings = std::move(warnings);
  return GstreamerSink::start(std::move(target), format);
}

std::vector<std::string> audio_left_out(const std::string& out,
                                        const std::optional<AudioTrack>& audio) {
  if (!audio || !has_audio(*audio)) {
    return {};
  }
  return {fmt::format("{}: the recording's audio is left out; only .mp4 and .mkv take it", out)};
}

}  // namespace

Result<std::unique_ptr<FrameSink>> open_sink(const std::string& out, const SinkFormat& format,
                                             const std::optional<AudioTrack>& audio) {
  if (auto started = init_gstreamer(); !started) {
    return tl::unexpected(started.error());
  }
  if (out == "-") {
    return Y4mSink::open_stdout(format, audio_left_out("-", audio));
  }
  if (out.find(" ! ") != std::string::npos) {
    return open_pipeline(out, format, audio_left_out("pipeline", audio));
  }
  const std::filesystem::path folder = std::filesystem::path(out).parent_path();
  std::error_code error;
  if (!folder.empty() && !std::filesystem::is_directory(folder, error)) {
    return bad_input(fmt::format("{}: there is no folder {}: make it first", out, folder.string()));
  }
  const std::string extension = lower_case_extension(out);
  if (extension == ".y4m") {
    return Y4mSink::open_file(out, format, audio_left_out(out, audio));
  }
  if (extension == ".mp4" || extension == ".mkv") {
    return open_video_file(out, format, audio);
  }
  return bad_input(
      fmt::format("{}: cannot tell what to write: end it in .mp4, .mkv or .y4m, or give - or a "
                  "pipeline with \" ! \"",
                  out));
}

}  // namespace gimbal
