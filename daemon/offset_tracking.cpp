#include "daemon/offset_tracking.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <string>
#include <utility>
#include <variant>

#include "daemon/journal.hpp"
#include "drivers/clock/monotonic_now.hpp"
#include "pipeline/pixels/nv12_frame.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kBurst_frames = 4;
constexpr double kBurstFps = 30;  // closer frames hardly differ
constexpr int kCorners = 40;
constexpr SensorDuration kBetweenBursts = milliseconds(400);
constexpr SensorDuration kReportEvery = milliseconds(200);
constexpr SensorDuration kLook = milliseconds(20);
constexpr SensorDuration kPatience = std::chrono::seconds(2);  // with a silent gyroscope
constexpr int kNice = 10;
constexpr SensorDuration kLoggedChange = milliseconds(1);
constexpr SensorDuration kJump = milliseconds(5);
constexpr SensorDuration kLogAgain = std::chrono::minutes(1);

SensorDuration thread_cpu_time() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

double in_ms(SensorDuration duration) {
  return to_seconds(duration) * 1e3;
}

void tell_of(const Error& error) {
  log_line(LogLevel::warning, "the time offset cannot be told by these frames: " + error.message,
           {"offset", {}});
}

}  // namespace

Result<std::unique_ptr<OffsetTracking>> OffsetTracking::create(const CameraCalibration& camera,
                                                               const ImuCalibration& imu,
                                                               const CornerFollower& corners,
                                                               double cpu_share) {
  auto tracker = OffsetTracker::create(camera, imu);
  if (!tracker) return tl::unexpected(tracker.error());
  return std::unique_ptr<OffsetTracking>(
      new OffsetTracking(*std::move(tracker), camera, corners, cpu_share));
}

OffsetTracking::OffsetTracking(OffsetTracker tracker, const CameraCalibration& camera,
                               const CornerFollower& corners, double cpu_share)
    : corners_(corners),
      block_px_(block_for(camera.size)),
      stride_frames_(std::max(1, static_cast<int>(std::lround(camera.fps / kBurstFps)))),
      cpu_share_(cpu_share),
      tracker_(std::move(tracker)) {}

OffsetTracking::~OffsetTracking() {
  stop();
}

void OffsetTracking::start(Use use) {
  use_ = std::move(use);
  thread_ = std::thread([this] { run(); });
}

void OffsetTracking::stop() {
  {
    const std::lock_guard lock(mutex_);
    stops_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

// --- on the sources' threads --------------------------------------------------------------------

void OffsetTracking::saw(const VideoFrame& frame) {
  if (frame.stamp.time <= last_frame_.load()) return growing_.clear();  // one that is not shown
  last_frame_ = frame.stamp.time;
  if (growing_.empty() && monotonic_now() < next_burst_.load()) return;
  if (!growing_.empty() && ++passed_ % stride_frames_ != 0) return;
  passed_ = 0;
  const SensorDuration begin = thread_cpu_time();
  auto picture = corners_.small_picture(as_nv12(frame), block_px_);
  copy_time_ = copy_time_.load() + (thread_cpu_time() - begin);
  if (!picture) {
    growing_.clear();
    next_burst_ = monotonic_now() + kBetweenBursts;
    return tell_of(picture.error());
  }
  growing_.push_back(*std::move(picture));
  if (growing_.size() < kBurst_frames) return;
  next_burst_ = SensorTime::max();  // until this one is done with
  {
    const std::lock_guard lock(mutex_);
    burst_ = std::exchange(growing_, {});
  }
  changed_.notify_all();
}

void OffsetTracking::saw(const ImuReading& reading) {
  const auto* const sample = std::get_if<GyroSample>(&reading);
  if (sample == nullptr) return;
  const std::lock_guard lock(mutex_);
  gyro_.push_back(*sample);
}

// --- on its own ---------------------------------------------------------------------------------

void OffsetTracking::run() {
  ::pthread_setname_np(::pthread_self(), "offset");  // as `top -H` shows it
  ::setpriority(PRIO_PROCESS, 0, kNice);             // on Linux this thread's alone
  while (const auto woken = wait_for_burst()) {
    if (!woken->empty()) {
      if (worth_of(*woken) == Worth::something) follow(*woken);
      pace();
    }
    report();
  }
}

/// An empty one when it is time to report; nothing after `stop`.
std::optional<OffsetTracking::Burst> OffsetTracking::wait_for_burst() {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kReportEvery, [this] { return stops_ || burst_; });
  if (stops_) return std::nullopt;
  Burst burst = std::exchange(burst_, std::nullopt).value_or(Burst());
  lock.unlock();
  take_gyro();
  return burst;
}

void OffsetTracking::take_gyro() {
  std::vector<GyroSample> samples;
  {
    const std::lock_guard lock(mutex_);
    samples.swap(gyro_);
  }
  for (const GyroSample& sample : samples) tracker_.push(sample);
}

/// Waits for the gyroscope's samples to come as far as the frames.
Worth OffsetTracking::worth_of(const Burst& burst) {
  const SensorTime end = monotonic_now() + kPatience;
  while (monotonic_now() < end) {
    take_gyro();
    const Worth worth = tracker_.worth_of(burst.front().stamp, burst.back().stamp);
    if (worth != Worth::unknown) return worth;
    std::unique_lock lock(mutex_);
    if (changed_.wait_for(lock, kLook, [this] { return stops_; })) break;
  }
  return Worth::nothing;
}

void OffsetTracking::follow(const Burst& pictures) {
  const auto burst = corners_.follow_burst(pictures, kCorners);
  if (!burst) return tell_of(burst.error());
  tracker_.push(*burst);
}

/// Lets the next burst come when the share of a core allows it.
void OffsetTracking::pace() {
  const SensorDuration spent = cpu_time();
  const double busy_s = to_seconds(spent - std::exchange(paced_cpu_time_, spent));
  next_burst_ =
      monotonic_now() + std::max(kBetweenBursts, duration_from_seconds(busy_s / cpu_share_));
}

SensorDuration OffsetTracking::cpu_time() const {
  return thread_cpu_time() + copy_time_.load();
}

void OffsetTracking::report() {
  const OffsetEstimate estimate = tracker_.estimate_at(last_frame_);
  log_changes(estimate);
  if (use_) use_({estimate, cpu_time()});
}

void OffsetTracking::log_changes(const OffsetEstimate& estimate) {
  if (!estimate.is_known) return;
  const std::string value =
      fmt::format("{:.1f} ms ± {:.1f}", in_ms(estimate.offset), in_ms(estimate.sigma));
  const SensorTime now = monotonic_now();
  const auto last = std::exchange(last_known_, estimate.offset);
  std::string text;
  if (!last) {
    text = "the camera's time offset is " + value;
  } else if (std::chrono::abs(estimate.offset - *last) > kJump) {
    text = fmt::format("the camera's time offset jumped from {:.1f} ms to {}", in_ms(*last), value);
  } else if (std::chrono::abs(estimate.offset - logged_) > kLoggedChange &&
             now - logged_at_ > kLogAgain) {
    text = fmt::format("the camera's time offset is {}, {:+.1f} ms a minute", value,
                       60e3 * estimate.drift);
  } else {
    return;
  }
  log_line(LogLevel::info, text, {"offset", {}});
  logged_ = estimate.offset;
  logged_at_ = now;
}

}  // namespace gimbal
