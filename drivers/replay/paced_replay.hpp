#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "drivers/camera_source.hpp"
#include "drivers/clock/monotonic_now.hpp"
#include "drivers/imu_source.hpp"
#include "drivers/replay/replay_camera.hpp"
#include "drivers/replay/replay_imu.hpp"

namespace gimbal {

/// Whether a recording begins anew at its end.
enum class Repeat : std::uint8_t { once, forever };

/// Puts a recording's stamps onto CLOCK_MONOTONIC, pass by pass; a pass is as long as the frames
/// last, so that they come without a gap. Camera and IMU of a paced replay share one, and the
/// camera's start begins it.
class ReplayTimeline {
 public:
  explicit ReplayTimeline(const Session& session);

  void begin_at(SensorTime live) { begin_ = live; }

  [[nodiscard]] SensorTime first() const { return first_; }

  [[nodiscard]] bool is_in_pass(SensorTime recorded, std::int64_t pass) const {
    return recorded < first_ + period_ && (pass == 0 || recorded >= first_);
  }

  [[nodiscard]] SensorTime live(SensorTime recorded, std::int64_t pass) const {
    return begin_.load() + (recorded - first_) + pass * period_;
  }

 private:
  SensorTime first_;         ///< of the recording's frames, on the IMU's clock
  SensorDuration period_{};  ///< from a pass to the next
  std::atomic<SensorTime> begin_ = SensorTime{};
};

/// Waits for instants, until it is told to stop.
class Pace {
 public:
  /// False if `stop` was called before the instant came.
  [[nodiscard]] bool wait_until(SensorTime time);
  void stop();
  void restart();

 private:
  std::mutex mutex_;
  std::condition_variable stopped_;
  bool is_stopped_ = false;
};

/// A recording's frames as if a camera delivered them now: each once its readout has ended. `stop`
/// may be called while another thread waits in `read`.
class PacedCamera final : public CameraSource {
 public:
  PacedCamera(const Session& session, std::shared_ptr<ReplayTimeline> timeline, Repeat repeat);

  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] CameraFormat format() const override { return camera_.format(); }
  void ask_for(PictureForm form) override { camera_.ask_for(form); }
  [[nodiscard]] Result<std::optional<VideoFrame>> read() override;
  void stop() override;
  [[nodiscard]] std::vector<std::string> remarks() const override { return remarks_; }

 private:
  [[nodiscard]] Result<std::optional<VideoFrame>> read_recorded();

  ReplayCamera camera_;
  std::shared_ptr<ReplayTimeline> timeline_;
  Repeat repeat_;
  SensorDuration delivery_delay_;
  std::vector<std::string> remarks_;  ///< of the last pass that came to its end
  std::int64_t pass_ = 0;
  std::int64_t next_index_ = 0;
  Pace pace_;
};

/// A recording's inertial samples as if an IMU delivered them now, each at its instant. To be
/// started after the camera.
class PacedImu final : public ImuSource {
 public:
  PacedImu(const Session& session, std::shared_ptr<const ReplayTimeline> timeline, Repeat repeat);

  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<std::optional<ImuReading>> read() override;
  void stop() override;

 private:
  [[nodiscard]] Result<std::optional<ImuReading>> read_recorded();

  ReplayImu imu_;
  std::shared_ptr<const ReplayTimeline> timeline_;
  Repeat repeat_;
  std::int64_t pass_ = 0;
  Pace pace_;
};

}  // namespace gimbal
