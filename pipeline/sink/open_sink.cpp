#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
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

enum class SinkKind : std::uint8_t { standard_output, pipeline, y4m_file, video_file };

Result<SinkKind> kind_of(const std::string& out) {
  if (out == "-") return SinkKind::standard_output;
  if (out.find(" ! ") != std::string::npos) return SinkKind::pipeline;
  const std::string extension = lower_case_extension(out);
  if (extension == ".y4m") return SinkKind::y4m_file;
  if (extension == ".mp4" || extension == ".mkv") return SinkKind::video_file;
  return bad_input(
      fmt::format("{}: cannot tell what to write: end it in .mp4, .mkv or .y4m, or give - or a "
                  "pipeline with \" ! \"",
                  out));
}

Result<void> check_folder_of(const std::string& file) {
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  std::error_code error;
  if (folder.empty() || std::filesystem::is_directory(folder, error)) return {};
  return bad_input(fmt::format("{}: there is no folder {}: make it first", file, folder.string()));
}

}  // namespace

Result<void> check_sink_text(const std::string& out) {
  const auto kind = kind_of(out);
  return kind ? Result<void>() : tl::unexpected(kind.error());
}

Result<std::unique_ptr<FrameSink>> open_sink(const std::string& out, const SinkFormat& format,
                                             const std::optional<AudioTrack>& audio) {
  if (auto started = init_gstreamer(); !started) {
    return tl::unexpected(started.error());
  }
  const auto kind = kind_of(out);
  if (!kind) return tl::unexpected(kind.error());
  if (*kind == SinkKind::standard_output) {
    return Y4mSink::open_stdout(format, audio_left_out("-", audio));
  }
  if (*kind == SinkKind::pipeline) {
    return open_pipeline(out, format, audio_left_out("pipeline", audio));
  }
  if (auto there = check_folder_of(out); !there) return tl::unexpected(there.error());
  if (*kind == SinkKind::y4m_file) {
    return Y4mSink::open_file(out, format, audio_left_out(out, audio));
  }
  return open_video_file(out, format, audio);
}

}  // namespace gimbal
