#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>

#include "daemon/durable_file.hpp"
#include "drivers/imu_source.hpp"
#include "drivers/replay/session.hpp"
#include "pipeline/queue/bounded_queue.hpp"
#include "pipeline/sink/frame_sink.hpp"

namespace gimbal {

/// One session folder that is being written: pictures on one thread, samples on another, so that a
/// slow encoder costs no sample. What is given to it never waits; what does not fit is counted.
///
/// From the start on the folder is a session that can be opened, whatever happens: session.toml is
/// there before the first frame, the CSV files reach the disk twice a second, and the video is
/// Matroska, which plays as far as it goes.
class Recording {
 public:
  /// `about`: what is known of the camera and the IMU, with the new folder's path. `encoder`:
  /// pipeline text, empty for the best that is installed.
  [[nodiscard]] static Result<std::unique_ptr<Recording>> start(Session about,
                                                                const SinkFormat& format,
                                                                std::string encoder);

  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;
  ~Recording();

  void give(const VideoFrame& frame);
  void give(const ImuReading& reading);

  /// Writes what is held, ends the video properly and says in session.toml how long it is.
  void finish();

  [[nodiscard]] const std::filesystem::path& folder() const { return about_.folder; }
  [[nodiscard]] std::uint64_t frames_written() const { return frames_written_; }
  [[nodiscard]] std::uint64_t frames_dropped() const { return frames_.dropped(); }
  [[nodiscard]] std::uint64_t samples_written() const { return samples_written_; }
  [[nodiscard]] std::uint64_t samples_dropped() const { return samples_.dropped(); }

  /// Why nothing more is written: the disk is full, say. What was written stays.
  [[nodiscard]] std::optional<Error> failure() const;

 private:
  struct Logs {
    DurableFile frames;
    DurableFile gyro;
    std::optional<DurableFile> accel;  ///< begun with the first sample: there may be none
  };

  Recording(Session about, SinkFormat format, std::string encoder, Logs logs);

  [[nodiscard]] static Result<Logs> create_logs(const std::filesystem::path& folder);
  void write_frames();
  void write_samples();
  [[nodiscard]] Result<void> write(const VideoFrame& frame);
  [[nodiscard]] Result<void> write(const ImuReading& reading);
  [[nodiscard]] Result<void> write(const AccelSample& sample);
  [[nodiscard]] Result<void> open_video(const VideoFrame& frame);
  [[nodiscard]] Result<void> sync_video();
  void fail(const Error& error);

  Session about_;
  const SinkFormat format_;
  const std::string encoder_;
  Logs logs_;
  BoundedQueue<VideoFrame, WhenFull::drop_oldest> frames_;
  BoundedQueue<ImuReading, WhenFull::drop_oldest> samples_;

  // Used by the thread that writes frames.
  std::unique_ptr<FrameSink> video_;
  std::optional<FrameStamp> first_;
  std::optional<FrameStamp> last_;
  std::chrono::steady_clock::time_point last_video_sync_;

  std::atomic<std::uint64_t> frames_written_ = 0;
  std::atomic<std::uint64_t> samples_written_ = 0;
  mutable std::mutex mutex_;
  std::optional<Error> failure_;
  bool is_finished_ = false;
  std::thread frame_thread_;
  std::thread sample_thread_;
};

}  // namespace gimbal
