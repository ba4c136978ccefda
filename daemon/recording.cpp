#include "daemon/recording.hpp"

#include <fmt/format.h>

#include <utility>

#include "daemon/journal.hpp"
#include "drivers/replay/session_rows.hpp"
#include "drivers/replay/session_toml.hpp"
#include "drivers/replay/still.hpp"
#include "pipeline/sink/pipeline_text.hpp"
#include "pipeline/sink/video_encoder.hpp"

namespace gimbal {
namespace {

/// A hiccup of encoder or disk shorter than this costs nothing. Frames pin the driver's buffers.
constexpr std::size_t kHeldFrames = 16;
constexpr std::size_t kHeldSamples = 1 << 15;
constexpr int kThumbnailWidth_px = 320;
constexpr std::chrono::milliseconds kUnsynced{500};
constexpr const char* kVideoName = "video.mkv";

/// Clusters are short, and what is muxed goes straight to the kernel: a file that ends anywhere
/// plays up to there.
std::string video_text(const std::string& encoder, const std::filesystem::path& file) {
  return fmt::format(
      "{} ! matroskamux timecodescale=100000 min-cluster-duration=0 "
      "max-cluster-duration=500000000 ! filesink buffer-mode=unbuffered location={}",
      encoder, in_pipeline_quotes(file.string()));
}

}  // namespace

Result<std::unique_ptr<Recording>> Recording::start(Session about, const SinkFormat& format,
                                                    std::string encoder) {
  const SinkFormat even = with_even_size(format);
  if (encoder.empty()) {
    const auto chosen = choose_recording_encoder(even);
    if (!chosen) return tl::unexpected(chosen.error());
    encoder = chosen->text;
  }
  const std::filesystem::path folder = about.folder;
  if (auto made = make_session_folder(folder); !made) return tl::unexpected(made.error());
  auto written = replace_file(folder / "session.toml", format_session_toml(about)).and_then([&] {
    return sync_to_disk(folder.parent_path());
  });
  if (!written) return tl::unexpected(written.error());
  auto logs = create_logs(folder);
  if (!logs) return tl::unexpected(logs.error());
  if (auto listed = sync_to_disk(folder); !listed) return tl::unexpected(listed.error());
  std::unique_ptr<Recording> recording(
      new Recording(std::move(about), even, std::move(encoder), *std::move(logs)));
  recording->frame_thread_ = std::thread([self = recording.get()] { self->write_frames(); });
  recording->sample_thread_ = std::thread([self = recording.get()] { self->write_samples(); });
  return recording;
}

Result<Recording::Logs> Recording::create_logs(const std::filesystem::path& folder) {
  auto frames = DurableFile::create(folder / "frames.csv");
  auto gyro = DurableFile::create(folder / "gyro.csv");
  for (const auto* file : {&frames, &gyro}) {
    if (!*file) return tl::unexpected(file->error());
  }
  auto begun = frames->append(kFrameHeader).and_then([&] { return gyro->append(kVectorHeader); });
  if (!begun) return tl::unexpected(begun.error());
  return Logs{*std::move(frames), *std::move(gyro), std::nullopt};
}

Recording::Recording(Session about, SinkFormat format, std::string encoder, Logs logs)
    : about_(std::move(about)),
      format_(std::move(format)),
      encoder_(std::move(encoder)),
      logs_(std::move(logs)),
      frames_(kHeldFrames),
      samples_(kHeldSamples) {}

Recording::~Recording() {
  finish();
}

void Recording::give(const VideoFrame& frame) {
  frames_.push(frame);
}

void Recording::give(const ImuReading& reading) {
  samples_.push(reading);
}

void Recording::finish() {
  if (std::exchange(is_finished_, true)) return;
  frames_.close();
  samples_.close();
  frame_thread_.join();
  sample_thread_.join();
  // The duration is said now; the numbers behind it are in frames.csv.
  if (first_) about_.frames = {*first_, *last_};
  const auto written = replace_file(about_.folder / "session.toml", format_session_toml(about_));
  if (!written) fail(written.error());
}

std::optional<Error> Recording::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

void Recording::write_frames() {
  while (const auto frame = frames_.pop()) {
    if (auto written = write(*frame); !written) {
      fail(written.error());
      break;
    }
  }
  if (video_) {
    const auto ended =
        video_->finish().and_then([this] { return sync_to_disk(about_.folder / kVideoName); });
    if (!ended && !failure()) fail(ended.error());
    video_.reset();
  }
  if (auto synced = logs_.frames.sync(); !synced && !failure()) fail(synced.error());
}

Result<void> Recording::write(const VideoFrame& frame) {
  if (auto opened = open_video(frame); !opened) return opened;
  FrameStamp stamp = frame.stamp;
  stamp.index = static_cast<std::int64_t>(frames_written_);  // its place in the video
  // A picture without a stamp is useless, a stamp without a picture is passed over.
  auto written =
      logs_.frames.append(session_row(stamp)).and_then([&] { return video_->write(frame); });
  if (!written) return written;
  if (!first_) first_ = stamp;
  last_ = stamp;
  ++frames_written_;
  return sync_video();
}

Result<void> Recording::open_video(const VideoFrame& frame) {
  if (video_) return {};
  auto sink = open_sink(video_text(encoder_, about_.folder / kVideoName), format_, std::nullopt);
  if (!sink) return tl::unexpected(sink.error());
  video_ = std::move(*sink);
  if (auto still = write_still(frame, about_.folder / "thumbnail.jpg", kThumbnailWidth_px);
      !still) {
    log_line(LogLevel::warning, "recording: no thumbnail: " + still.error().message,
             {"recording", {}});
  }
  return {};
}

Result<void> Recording::sync_video() {
  const auto now = std::chrono::steady_clock::now();
  if (now - last_video_sync_ < kUnsynced) return {};
  last_video_sync_ = now;
  return sync_to_disk(about_.folder / kVideoName);
}

void Recording::write_samples() {
  while (const auto reading = samples_.pop()) {
    if (auto written = write(*reading); !written) {
      fail(written.error());
      break;
    }
    ++samples_written_;
  }
  auto synced = logs_.gyro.sync().and_then(
      [this] { return logs_.accel ? logs_.accel->sync() : Result<void>{}; });
  if (!synced && !failure()) fail(synced.error());
}

Result<void> Recording::write(const ImuReading& reading) {
  if (const auto* gyro = std::get_if<GyroSample>(&reading)) {
    return logs_.gyro.append(session_row(*gyro));
  }
  return write(std::get<AccelSample>(reading));
}

Result<void> Recording::write(const AccelSample& sample) {
  if (!logs_.accel) {
    auto file = DurableFile::create(about_.folder / "accel.csv");
    if (!file) return tl::unexpected(file.error());
    logs_.accel.emplace(*std::move(file));
    if (auto begun = logs_.accel->append(kVectorHeader); !begun) return begun;
  }
  return logs_.accel->append(session_row(sample));
}

/// Nothing more is taken; what was written stays as it is.
void Recording::fail(const Error& error) {
  {
    const std::lock_guard lock(mutex_);
    if (failure_) return;
    failure_ = error;
  }
  log_line(
      LogLevel::error,
      fmt::format("recording {}: {}; the stream goes on", about_.folder.string(), error.message),
      {"recording", about_.folder.native()});
  frames_.close();
  samples_.close();
}

}  // namespace gimbal
