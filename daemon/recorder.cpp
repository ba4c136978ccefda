#include "daemon/recorder.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <system_error>
#include <utility>

#include "daemon/name_now.hpp"
#include "daemon/state_folder.hpp"
#include "pipeline/pixels/nv12_frame.hpp"

namespace gimbal {
namespace {

constexpr std::uintmax_t kMegabyte = 1'000'000;

RecordingStatus status_of(const Recording& recording) {
  const auto failure = recording.failure();
  return {!failure,
          recording.folder(),
          recording.frames_written(),
          recording.frames_dropped(),
          recording.samples_written(),
          recording.samples_dropped(),
          failure ? failure->message : ""};
}

std::string rfc3339_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

}  // namespace

Recorder::Recorder(RecordingSettings settings, CameraFormat format, Session about)
    : settings_(std::move(settings)), format_(std::move(format)), about_(std::move(about)) {}

Recorder::~Recorder() = default;

void Recorder::saw(const VideoFrame& frame) {
  if (const auto recording = current()) recording->give(as_nv12(frame));
}

void Recorder::saw(const ImuReading& reading) {
  if (const auto recording = current()) recording->give(reading);
}

std::shared_ptr<Recording> Recorder::current() const {
  const std::lock_guard lock(mutex_);
  return recording_;
}

Result<std::filesystem::path> Recorder::new_folder() const {
  const std::filesystem::path parent =
      settings_.folder.empty() ? state_folder() / "sessions" : settings_.folder;
  std::error_code error;
  std::filesystem::create_directories(parent, error);
  if (error) {
    return bad_input(
        fmt::format("{}: no session can be made there: {}", parent.string(), error.message()));
  }
  const auto space = std::filesystem::space(parent, error);
  if (!error && space.available < settings_.min_free_mb * kMegabyte) {
    return bad_input(fmt::format("{}: only {} MB are free, {} are wanted (recording.min_free_mb)",
                                 parent.string(), space.available / kMegabyte,
                                 settings_.min_free_mb));
  }
  const std::string name = name_now();
  std::filesystem::path folder = parent / name;
  for (int i = 2; std::filesystem::exists(folder, error); ++i) {
    folder = parent / fmt::format("{}_{}", name, i);
  }
  return folder;
}

Result<std::filesystem::path> Recorder::start() {
  const std::lock_guard control(control_);
  if (const auto present = current()) {
    if (!present->failure()) {
      return bad_input(fmt::format("{} is being recorded already", present->folder().string()));
    }
    static_cast<void>(end());
  }
  auto folder = new_folder();
  if (!folder) return folder;
  Session about = about_;
  about.folder = *folder;
  about.recorded_at = rfc3339_now();
  if (const auto offset = corrected_time_offset(); offset && about.camera) {
    about.camera->time_offset = *offset;
  }
  auto recording = Recording::start(std::move(about), {format_.size, format_.fps, format_.color},
                                    settings_.encoder);
  if (!recording) return tl::unexpected(recording.error());
  const std::lock_guard lock(mutex_);
  recording_ = std::move(*recording);
  return *folder;
}

Result<RecordingStatus> Recorder::stop() {
  const std::lock_guard control(control_);
  if (!current()) return bad_input("nothing is being recorded");
  return end();
}

/// With `control_` held. The sources go on while the last is written.
RecordingStatus Recorder::end() {
  std::shared_ptr<Recording> ending;
  {
    const std::lock_guard lock(mutex_);
    ending = std::move(recording_);
    recording_.reset();
  }
  ending->finish();
  const std::lock_guard lock(mutex_);
  last_ = status_of(*ending);
  last_.is_recording = false;
  return last_;
}

void Recorder::correct(SensorDuration time_offset) {
  const std::lock_guard lock(mutex_);
  time_offset_ = time_offset;
}

std::optional<SensorDuration> Recorder::corrected_time_offset() const {
  const std::lock_guard lock(mutex_);
  return time_offset_;
}

RecordingStatus Recorder::status() const {
  const std::lock_guard lock(mutex_);
  return recording_ ? status_of(*recording_) : last_;
}

}  // namespace gimbal
