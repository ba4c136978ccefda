#include "pipeline/sink/video_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

#include "pipeline/gstreamer/gst_runtime.hpp"
#include "pipeline/sink/audio_branch.hpp"
#include "pipeline/sink/gstreamer_sink.hpp"
#include "pipeline/sink/video_encoder.hpp"

namespace gimbal {
namespace {

struct Container {
  const char* muxer;
  const char* settings;
  const char* remains;  ///< what becomes of the file if writing fails
};

/// The muxers' own choice of time scale rounds to the nominal rate (.mp4) or to 1 ms (.mkv). A
/// Matroska cluster spans at most 32767 ticks of its scale.
Container container_of(const std::filesystem::path& path) {
  if (lower_case_extension(path) == ".mp4") {
    return {"mp4mux", "trak-timescale=90000", "is incomplete and will not play"};
  }
  return {"matroskamux", "timecodescale=100000 max-cluster-duration=3000000000",
          "ends where writing failed"};
}

std::string size_warning(const std::filesystem::path& path, ImageSize given, ImageSize written) {
  return fmt::format(
      "{}: H.264 has even sizes only: written as {}x{}, without the last column or row of {}x{}",
      path.string(), written.width, written.height, given.width, given.height);
}

Result<std::unique_ptr<FrameSink>> start_file(const std::filesystem::path& path,
                                              const SinkFormat& format, std::string_view encoder,
                                              const std::optional<AudioTrack>& audio,
                                              SinkPipeline target) {
  const Container container = container_of(path);
  const AudioPlan plan = audio ? plan_audio(*audio, container.muxer) : AudioPlan{};
  auto pipeline = parse_pipeline(
      fmt::format("appsrc name={} ! videoconvert ! {} ! muxer.video_0 {} name=muxer {} ! filesink "
                  "name=output {}",
                  kFrameSourceName, encoder, container.muxer, container.settings, plan.text));
  if (!pipeline) {
    return tl::unexpected(pipeline.error());
  }
  g_object_set(element_named(*pipeline, "output").get(), "location", path.c_str(), nullptr);
  if (!plan.text.empty()) {
    target.audio = std::make_unique<AudioBranch>(*pipeline, *audio);
  }
  if (!plan.warning.empty()) {
    target.warnings.push_back(plan.warning);
  }
  target.pipeline = *std::move(pipeline);
  target.remains = fmt::format("{} {}", path.string(), container.remains);
  return GstreamerSink::start(std::move(target), format);
}

}  // namespace

std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return extension;
}

Result<std::unique_ptr<FrameSink>> open_video_file(const std::filesystem::path& path,
                                                   const SinkFormat& format,
                                                   const std::optional<AudioTrack>& audio) {
  const SinkFormat encoded = with_even_size(format);
  if (encoded.size.width == 0 || encoded.size.height == 0) {
    return bad_input(fmt::format("{}: {}x{} is too small for H.264", path.string(),
                                 format.size.width, format.size.height));
  }
  std::error_code ignored;
  if (audio && std::filesystem::equivalent(path, audio->file, ignored)) {
    return bad_input(
        fmt::format("{} is the recording itself: write to another file", path.string()));
  }
  const auto encoder = choose_video_encoder(encoded);
  if (!encoder) {
    return tl::unexpected(encoder.error());
  }
  SinkPipeline target;
  if (encoded.size != format.size) {
    target.warnings.push_back(size_warning(path, format.size, encoded.size));
  }
  return start_file(path, encoded, encoder->text, audio, std::move(target));
}

}  // namespace gimbal
