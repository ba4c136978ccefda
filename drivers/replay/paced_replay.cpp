#include "drivers/replay/paced_replay.hpp"

#include <algorithm>
#include <chrono>
#include <utility>
#include <variant>

#include "drivers/replay/session.hpp"

namespace gimbal {
namespace {

double fps_of(const Session& session) {
  return session.camera ? session.camera->fps : 0;
}

/// The offset from the camera's clock to the IMU's does not change how long a recording is.
SensorDuration camera_ahead(const Session& session) {
  return session.camera ? session.camera->time_offset : SensorDuration::zero();
}

SensorTime time_of(const ImuReading& reading) {
  return std::visit([](const auto& sample) { return sample.time; }, reading);
}

}  // namespace

ReplayTimeline::ReplayTimeline(const Session& session) {
  if (session.frames.size() > 1) {
    first_ = session.frames.front().time + camera_ahead(session);
    const SensorDuration span = session.frames.back().time - session.frames.front().time;
    // A pass ends where a next frame would be, so that frames keep their rate over the seam.
    period_ = span + span / static_cast<std::int64_t>(session.frames.size() - 1);
  } else if (session.gyro.size() > 1) {
    first_ = session.gyro.front().time;
    period_ = session.gyro.back().time - first_ + std::chrono::milliseconds(1);
  }
}

bool Pace::wait_until(SensorTime time) {
  std::unique_lock lock(mutex_);
  const auto until = std::chrono::steady_clock::time_point(
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(time.time_since_epoch()));
  return !stopped_.wait_until(lock, until, [this] { return is_stopped_; });
}

void Pace::stop() {
  const std::lock_guard lock(mutex_);
  is_stopped_ = true;
  stopped_.notify_all();
}

void Pace::restart() {
  const std::lock_guard lock(mutex_);
  is_stopped_ = false;
}

PacedCamera::PacedCamera(const Session& session, std::shared_ptr<ReplayTimeline> timeline,
                         Repeat repeat)
    : camera_(session.video, session.frames, fps_of(session)),
      timeline_(std::move(timeline)),
      repeat_(repeat),
      delivery_delay_(camera_ahead(session) +
                      (session.camera ? session.camera->readout : SensorDuration::zero())) {}

Result<void> PacedCamera::start() {
  pass_ = 0;
  next_index_ = 0;
  pace_.restart();
  if (auto started = camera_.start(); !started) return started;
  timeline_->begin_at(monotonic_now());
  return {};
}

Result<std::optional<VideoFrame>> PacedCamera::read() {
  auto frame = read_recorded();
  if (!frame || !*frame) return frame;
  FrameStamp& stamp = (*frame)->stamp;
  stamp.time = timeline_->live(stamp.time, pass_);
  stamp.index = next_index_++;
  if (!pace_.wait_until(stamp.time + delivery_delay_)) return std::optional<VideoFrame>();
  return frame;
}

Result<std::optional<VideoFrame>> PacedCamera::read_recorded() {
  auto frame = camera_.read();
  if (frame && !*frame) remarks_ = camera_.warnings();
  if (!frame || *frame || repeat_ == Repeat::once) return frame;
  if (!pace_.wait_until(SensorTime::min())) return frame;  // ended because it was stopped
  if (auto rewound = camera_.rewind(); !rewound) return tl::unexpected(rewound.error());
  ++pass_;
  return camera_.read();
}

void PacedCamera::stop() {
  pace_.stop();
}

PacedImu::PacedImu(const Session& session, std::shared_ptr<const ReplayTimeline> timeline,
                   Repeat repeat)
    : imu_(session), timeline_(std::move(timeline)), repeat_(repeat) {}

Result<void> PacedImu::start() {
  pass_ = 0;
  pace_.restart();
  return imu_.start();
}

Result<std::optional<ImuReading>> PacedImu::read() {
  auto reading = read_recorded();
  if (!reading || !*reading) return reading;
  const SensorTime time = timeline_->live(time_of(**reading), pass_);
  std::visit([&](auto& sample) { sample.time = time; }, **reading);
  if (!pace_.wait_until(time)) return std::optional<ImuReading>();
  return reading;
}

/// Samples before the first frame serve in the first pass alone; those after the last frame's time
/// only where no other pass follows.
Result<std::optional<ImuReading>> PacedImu::read_recorded() {
  while (true) {
    auto reading = imu_.read();
    if (!reading) return reading;
    const bool is_in_pass = *reading && timeline_->is_in_pass(time_of(**reading), pass_);
    if (is_in_pass || repeat_ == Repeat::once) return reading;
    if (*reading && time_of(**reading) < timeline_->first()) continue;
    if (!pace_.wait_until(SensorTime::min())) return std::optional<ImuReading>();  // was stopped
    ++pass_;
    if (auto started = imu_.start(); !started) return tl::unexpected(started.error());
  }
}

void PacedImu::stop() {
  pace_.stop();
}

}  // namespace gimbal
