#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "daemon/live_pipeline.hpp"
#include "daemon/recording.hpp"
#include "daemon/recording_settings.hpp"
#include "drivers/replay/session.hpp"

namespace gimbal {

struct RecordingStatus {
  bool is_recording = false;
  std::filesystem::path folder;  ///< of the present or the last recording; empty if none
  std::uint64_t frames = 0;
  std::uint64_t frames_dropped = 0;
  std::uint64_t samples = 0;
  std::uint64_t samples_dropped = 0;
  std::string failure;  ///< why the last recording ended by itself; empty if it did not
};

/// Records what camera and IMU deliver, before anything is done to it, while the steady stream goes
/// on: session folders, one after the other. Any thread may ask.
class Recorder final : public SourceObserver {
 public:
  /// `about`: what is known of the camera and the IMU.
  Recorder(RecordingSettings settings, CameraFormat format, Session about);
  ~Recorder() override;

  void saw(const VideoFrame& frame) override;
  void saw(const ImuReading& reading) override;

  /// The new session's folder. bad_input if one is being recorded, or cannot be begun.
  [[nodiscard]] Result<std::filesystem::path> start();

  /// Returns when all is written. bad_input if nothing is being recorded.
  [[nodiscard]] Result<RecordingStatus> stop();

  /// What the time offset has turned out to be: sessions begun from now on say so.
  void correct(SensorDuration time_offset);

  [[nodiscard]] RecordingStatus status() const;

 private:
  [[nodiscard]] Result<std::filesystem::path> new_folder() const;
  RecordingStatus end();
  [[nodiscard]] std::optional<SensorDuration> corrected_time_offset() const;
  [[nodiscard]] std::shared_ptr<Recording> current() const;

  const RecordingSettings settings_;
  const CameraFormat format_;
  const Session about_;
  mutable std::mutex control_;  ///< held while one is begun or ended
  mutable std::mutex mutex_;    ///< of what follows; never for long
  std::shared_ptr<Recording> recording_;
  RecordingStatus last_;
  std::optional<SensorDuration> time_offset_;  ///< other than `about` has it
};

}  // namespace gimbal
