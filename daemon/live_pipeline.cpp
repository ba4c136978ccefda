#include "daemon/live_pipeline.hpp"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "daemon/journal.hpp"
#include "daemon/no_signal.hpp"
#include "drivers/clock/monotonic_now.hpp"

namespace gimbal {
namespace {

/// Two seconds of a fast IMU.
constexpr std::size_t kHeldInflow = 4096;
/// What may wait for the one that draws: more would only be late.
constexpr std::size_t kHeldDrawings = 2;
/// How much longer frames may wait for orientations than the path waits for frames.
constexpr double kPatience_s = 0.5;
constexpr std::size_t kThreads = 4;
constexpr std::size_t kRememberedAges = 1000;
/// A live accelerometer that is silent must not hold the gyroscope back for long.
constexpr ImuAlignerParameters kLiveAligner{.patience = std::chrono::milliseconds(100)};
/// An IMU that is further behind the frames is silent. Its buffers may well hold a tenth of a
/// second.
constexpr SensorDuration kSilence = std::chrono::milliseconds(300);
/// A stamp further from now is not on this clock.
constexpr SensorDuration kOffClock = std::chrono::seconds(1);
/// Without frames, orientations are of no use for longer.
constexpr SensorDuration kRememberedAttitudes = std::chrono::seconds(1);

double usual_fps(const CameraCalibration& calibration) {
  return calibration.fps > 0 ? calibration.fps : kThesisFps;
}

/// Samples of an IMU whose clock is ahead come as much later than the frames that they are for.
SensorDuration wait_for_samples(const CameraCalibration& calibration) {
  return std::max(calibration.time_offset, SensorDuration::zero());
}

std::size_t most_held(const StabilizationSettings& settings, const CameraCalibration& calibration) {
  const double patience_s = kPatience_s + to_seconds(wait_for_samples(calibration));
  return settings.latency.value_or(0) +
         static_cast<std::size_t>(std::ceil(patience_s * usual_fps(calibration)));
}

/// Of a frame that is drawn in time behind its stamp: the lag, the readout, and some frames for
/// the stages and their queues.
SensorDuration longest_delay(const StabilizationSettings& settings,
                             const CameraCalibration& calibration) {
  constexpr double kStages_frames = 3;
  const double lag_frames = static_cast<double>(settings.latency.value_or(0));
  return calibration.readout + wait_for_samples(calibration) +
         duration_from_seconds((lag_frames + kStages_frames) / usual_fps(calibration));
}

SensorTime stamp_of(const ImuReading& reading) {
  return std::visit([](const auto& sample) { return sample.time; }, reading);
}

}  // namespace

Result<std::unique_ptr<LivePipeline>> LivePipeline::start(
    LiveSources sources, const StabilizationSettings& settings,
    const std::vector<OutputSettings>& outputs, std::vector<SourceObserver*> observers) {
  if (auto sound = check_horizon(settings, sources.accelerometer); !sound) {
    return tl::unexpected(sound.error());
  }
  AttitudeEkfParameters ekf;
  ekf.remembered_bias = sources.remembered_bias;
  auto stabilizer = Stabilizer::create(sources.camera_calibration, sources.imu_calibration,
                                       make_prompt_attitudes(settings.estimator, ekf),
                                       make_path(settings, usual_fps(sources.camera_calibration)),
                                       stabilizer_options(settings));
  if (!stabilizer) return tl::unexpected(stabilizer.error());
  if (sources.format.size != sources.camera_calibration.size) {
    return bad_input("the camera delivers another size of picture than its calibration is for");
  }
  std::unique_ptr<LivePipeline> pipeline(new LivePipeline(
      std::move(sources), std::move(*stabilizer), settings, outputs, std::move(observers)));
  if (auto started = pipeline->start_threads(); !started) return tl::unexpected(started.error());
  return pipeline;
}

/// The sources start last, so that no frame waits for a renderer that is being opened.
Result<void> LivePipeline::start_threads() {
  std::promise<Result<void>> can_draw;
  auto drawing = can_draw.get_future();
  threads_.emplace_back([this, &can_draw] { draw(can_draw); });
  if (auto opened = drawing.get(); !opened) return opened;
  camera_.ask_for(wanted_form_);
  threads_.emplace_back([this] { follow(); });
  if (auto started = camera_.start(); !started) return started;
  if (auto started = imu_.start(); !started) return started;
  threads_.emplace_back([this] { read_imu(); });
  threads_.emplace_back([this] { read_camera(); });
  return {};
}

LivePipeline::LivePipeline(LiveSources sources, Stabilizer stabilizer,
                           const StabilizationSettings& settings,
                           const std::vector<OutputSettings>& outputs,
                           std::vector<SourceObserver*> observers)
    : camera_("camera", std::move(sources.camera)),
      imu_("imu", std::move(sources.imu)),
      format_(sources.format),
      calibration_(sources.camera_calibration),
      imu_calibration_(sources.imu_calibration),
      accelerometer_(sources.accelerometer),
      observers_(std::move(observers)),
      inflow_(kHeldInflow),
      drawings_(kHeldDrawings),
      settings_(settings),
      stabilizer_(std::move(stabilizer)),
      aligner_(sources.accelerometer, kLiveAligner) {
  for (const OutputSettings& output : outputs) {
    outputs_.push_back(std::make_unique<Output>(target_of(output), format_.fps,
                                                longest_delay(settings, calibration_)));
  }
}

LivePipeline::~LivePipeline() {
  stop();
}

void LivePipeline::stop() {
  camera_.stop();
  imu_.stop();
  if (threads_.size() < kThreads) inflow_.close();  // a source that never ran does not end it
  for (std::thread& thread : threads_) {
    if (thread.joinable()) thread.join();
  }
  for (const auto& output : outputs_) output->end();
  std::vector<std::thread> endings;  // side by side: one that is stuck costs the others no time
  for (const auto& output : outputs_) {
    endings.emplace_back([&output] { output->finish(); });
  }
  for (std::thread& ending : endings) ending.join();
}

Result<void> LivePipeline::check(const StabilizationSettings& settings) const {
  return check_horizon(settings, accelerometer_);
}

void LivePipeline::apply(const StabilizationSettings& settings) {
  inflow_.push(settings);
}

void LivePipeline::use(const OffsetReport& offset) {
  if (offset.estimate.is_known) {
    wanted_correction_ = offset.estimate.offset - calibration_.time_offset;
  }
  const std::lock_guard lock(mutex_);
  tracked_offset_ = offset;
}

std::unique_ptr<CameraPath> LivePipeline::new_path() const {
  return make_path(settings_, usual_fps(calibration_));
}

// --- reading ------------------------------------------------------------------------------------

void LivePipeline::read_camera() {
  while (true) {
    auto reading = camera_.read();
    if (auto* frame = std::get_if<VideoFrame>(&reading)) {
      ++frames_in_;
      is_camera_lost_ = false;
      if (frame->stamp.time - monotonic_now() > kOffClock) {
        ++dropped_off_clock_;  // or all that come after it would seem to be late
        continue;
      }
      for (SourceObserver* observer : observers_) observer->saw(*frame);
      if (!inflow_.push(std::move(*frame))) break;
    } else if (std::holds_alternative<SourceLost>(reading)) {
      is_camera_lost_ = true;
      if (!inflow_.push(SourceLost{})) break;
    } else {
      break;
    }
  }
  inflow_.push(SourceEnd{});
}

void LivePipeline::read_imu() {
  while (true) {
    const auto reading = imu_.read();
    if (std::holds_alternative<SourceEnd>(reading)) break;
    const auto* sample = std::get_if<ImuReading>(&reading);
    if (sample == nullptr) continue;  // the frames show how long the silence lasts
    ++samples_;
    const SensorDuration off = stamp_of(*sample) - monotonic_now();
    if (off > kOffClock || off < -kOffClock) {
      ++samples_off_clock_;
      continue;
    }
    for (SourceObserver* observer : observers_) observer->saw(*sample);
    if (!std::visit([&](const auto& one) { return inflow_.push(one); }, *sample)) break;
  }
  inflow_.push(SourceEnd{});
}

// --- following the camera -----------------------------------------------------------------------

void LivePipeline::follow() {
  SensorDuration busy{};  // since the frame before
  while (sources_running_ > 0) {
    const auto item = inflow_.pop();
    if (!item) break;
    const SensorTime begin = monotonic_now();
    std::visit([this](const auto& one) { take(one); }, *item);
    while (const auto camera = stabilizer_.next_camera()) hand_on(*camera);
    busy += monotonic_now() - begin;
    if (std::holds_alternative<VideoFrame>(*item)) {
      follow_time_.add(std::exchange(busy, SensorDuration::zero()));
    }
    frames_held_ = held_.size();
  }
  aligner_.finish();
  push_aligned_samples();
  stabilizer_.finish();
  hand_on_all();
  drawings_.close();
}

void LivePipeline::take(const GyroSample& sample) {
  gyro_rate_.add(sample.time);
  aligner_.push(sample);
  push_aligned_samples();
}

void LivePipeline::take(const AccelSample& sample) {
  aligner_.push(sample);
  push_aligned_samples();
}

void LivePipeline::take(const VideoFrame& frame) {
  if (last_frame_ && frame.stamp.time <= *last_frame_) {
    ++dropped_out_of_order_;
    return;
  }
  if (held_.size() >= most_held(settings_, calibration_)) {
    ++dropped_without_orientation_;
    return;
  }
  last_frame_ = frame.stamp.time;
  correction_ = glide_.towards(wanted_correction_, frame.stamp.time);
  held_.push_back(frame);
  FrameStamp& stamp = held_.back().stamp;
  stamp.clock_correction = correction_;
  stabilizer_.push(stamp);
  coast_if_the_imu_is_silent(stamp);
}

void LivePipeline::take(const StabilizationSettings& settings) {
  take_over_live(settings, settings_);
  stabilizer_.replace_path(new_path(), stabilizer_options(settings_));
  hand_on_all();
}

/// Nothing will come that the held frames could wait for.
void LivePipeline::take(SourceLost) {
  stabilizer_.begin_path(new_path());
  hand_on_all();
  past_.clear();
}

void LivePipeline::take(SourceEnd) {
  --sources_running_;
}

void LivePipeline::push_aligned_samples() {
  while (const auto sample = aligner_.pop()) {
    last_sample_ = sample->time;
    is_coasting_ = false;
    stabilizer_.push(*sample);
    if (held_.empty()) {
      stabilizer_.forget_before(sample->time - kRememberedAttitudes -
                                std::max(-calibration_.time_offset, SensorDuration::zero()));
    }
  }
}

/// The frames are the clock here, so a replay does the same each time.
void LivePipeline::coast_if_the_imu_is_silent(const FrameStamp& stamp) {
  const SensorDuration offset = stamp.clock_correction + calibration_.time_offset;
  // Samples whose clock is ahead come as much later, but they come.
  const SensorTime expected = stamp.time + std::min(offset, SensorDuration::zero());
  if (!last_sample_) last_sample_ = expected;
  if (expected - *last_sample_ < kSilence) return;
  is_coasting_ = true;
  stabilizer_.coast_to(stamp.time + offset + calibration_.readout);
}

/// For what the path held and lets go at once: many frames in no time, but none of them is late.
void LivePipeline::hand_on_all() {
  while (const auto camera = stabilizer_.next_camera()) {
    drawings_.wait_for_room();
    hand_on(*camera);
  }
}

/// Cameras come in the order of the frames that were pushed.
void LivePipeline::hand_on(const VirtualCamera& camera) {
  {
    const std::lock_guard lock(mutex_);
    attitude_ = {stabilizer_.time_of_pose(camera.stamp),
                 stabilizer_.real_pose(camera.stamp).q_world_camera};
    suspicion_ = stabilizer_.suspicion();
    gyro_bias_ = stabilizer_.gyro_bias();
  }
  drawings_.push({held_.front(), stabilizer_.mesh_for(camera), neighbours_of(camera)});
  let_go_of_first();
}

std::vector<Neighbour> LivePipeline::neighbours_of(const VirtualCamera& camera) const {
  if (settings_.border != Border::fill) return {};
  std::vector<VideoFrame> others(past_.frames().begin(), past_.frames().end());
  const std::size_t ahead =
      std::min({held_.size() - 1, settings_.latency.value_or(kMostFramesAhead), kMostFramesAhead});
  const auto next = std::next(held_.begin());
  others.insert(others.end(), next, next + static_cast<std::ptrdiff_t>(ahead));
  return stabilizer_.neighbours_of(camera, others);
}

void LivePipeline::let_go_of_first() {
  if (settings_.border == Border::fill) {
    past_.push(held_.front());
  } else {
    past_.clear();
  }
  stabilizer_.forget(past_.frames().empty() ? held_.front().stamp : past_.frames().front().stamp);
  held_.pop_front();
}

// --- drawing ------------------------------------------------------------------------------------

void LivePipeline::draw(std::promise<Result<void>>& can_draw) {
  ::pthread_setname_np(::pthread_self(), "draw");  // as `top -H` shows it
  auto warper = open_warper(settings_.dma_bufs);
  if (!warper) {
    can_draw.set_value(tl::unexpected(warper.error()));
    return;
  }
  if ((*warper)->takes_native_pictures()) wanted_form_ = PictureForm::native;
  can_draw.set_value({});
  const auto period = duration_from_seconds(1 / usual_fps(calibration_));
  FrameDrawer drawer(std::move(*warper),
                     [this](std::unique_ptr<Warper> failed, const Error& error) {
                       return open_warper_again(std::move(failed), error);
                     });
  while (!drawings_.is_at_end() || !drawer.is_idle()) {
    auto drawn = drawer.advance(drawings_, period);
    if (!drawn) {
      fail(drawn.error());
      return;
    }
    if (*drawn) {
      tell_transfers(drawer.warper());
      hand_out(**std::move(drawn));
    } else if (drawer.is_idle() && is_camera_lost_) {
      drawer.warper().forget_frames();
      draw_no_signal();
    }
  }
  has_ended_ = true;
}

void LivePipeline::hand_out(DrawnFrame drawn) {
  drawing_time_.add(drawn.time);
  note_age(monotonic_now() - drawn.picture.stamp.time);
  ++frames_out_;
  show(std::move(drawn.picture));
}

Result<std::unique_ptr<Warper>> LivePipeline::open_warper(DmaBufUse dma_bufs) {
  StabilizationSettings settings = settings_;
  settings.dma_bufs = dma_bufs;
  auto chosen = choose_warper(settings, calibration_.size);
  if (!chosen) return tl::unexpected(chosen.error());
  if (!chosen->warning.empty()) log_line(LogLevel::warning, chosen->warning, {"renderer", {}});
  const std::lock_guard lock(mutex_);
  renderer_ = chosen->warper->name() + ", " + chosen->warper->renderer();
  return std::move(chosen->warper);
}

/// A renderer that was reset draws again without dma-bufs, which may have been the reason.
Result<std::unique_ptr<Warper>> LivePipeline::open_warper_again(std::unique_ptr<Warper> failed,
                                                                const Error& error) {
  log_line(LogLevel::error, error.message + "; opening the renderer again", {"renderer", {}});
  failed.reset();
  return open_warper(DmaBufUse::never);
}

/// Which way pictures take to the GPU and back is known once one was drawn.
void LivePipeline::tell_transfers(const Warper& warper) {
  const std::string_view transfers = warper.transfers();
  if (transfers == transfers_) return;  // which only this thread writes
  const std::lock_guard lock(mutex_);
  transfers_ = transfers;
}

/// Stamped as late as a frame would be that is drawn now.
void LivePipeline::draw_no_signal() {
  if (!no_signal_) no_signal_ = no_signal_picture(format_.size, format_.color);
  VideoFrame picture = *no_signal_;
  picture.stamp.time = monotonic_now() - age().median;
  ++no_signal_pictures_;
  show(std::move(picture));
}

/// Outputs want stamps that rise, whatever the sources do.
void LivePipeline::show(VideoFrame frame) {
  if (last_shown_ && frame.stamp.time <= *last_shown_) {
    frame.stamp.time = *last_shown_ + std::chrono::microseconds(1);
  }
  last_shown_ = frame.stamp.time;
  for (const auto& output : outputs_) output->offer(frame);
}

// --- how it goes --------------------------------------------------------------------------------

void LivePipeline::note_age(SensorDuration age) {
  drawn_age_.add(age);
  const std::lock_guard lock(mutex_);
  ages_.push_back(age);
  if (ages_.size() > kRememberedAges) ages_.pop_front();
}

void LivePipeline::fail(const Error& error) {
  {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = error;
  }
  inflow_.close();
  drawings_.close();
  has_ended_ = true;
}

bool LivePipeline::has_ended() const {
  return has_ended_ || std::ranges::all_of(outputs_, [](const auto& o) { return o->is_gone(); });
}

std::optional<Error> LivePipeline::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

std::string LivePipeline::transfers() const {
  const std::lock_guard lock(mutex_);
  return transfers_;
}

std::string LivePipeline::renderer() const {
  const std::lock_guard lock(mutex_);
  return renderer_;
}

std::optional<GyroBias> LivePipeline::gyro_bias() const {
  const std::lock_guard lock(mutex_);
  return gyro_bias_;
}

LiveStatus LivePipeline::status() const {
  LiveStatus status;
  status.camera = camera_.status();
  status.imu = imu_.status();
  status.is_coasting = is_coasting_;
  status.counts = counts();
  status.age = age();
  status.gyro_rate_hz = gyro_rate_.rate_hz();
  status.frames_held = frames_held_;
  status.inflow_depth = inflow_.size();
  status.drawings_depth = drawings_.size();
  status.follow_time = follow_time_.counts();
  status.drawing_time = drawing_time_.counts();
  status.drawn_age = drawn_age_.counts();
  const std::lock_guard lock(mutex_);
  status.time_offset = calibration_.time_offset + correction_.load();
  status.attitude = attitude_;
  status.tracked_offset = tracked_offset_;
  status.suspicion = suspicion_;
  return status;
}

LiveCounts LivePipeline::counts() const {
  LiveCounts counts;
  counts.frames_in = frames_in_;
  counts.frames_out = frames_out_;
  counts.dropped_without_orientation = dropped_without_orientation_;
  counts.dropped_before_drawing = drawings_.dropped();
  counts.dropped_out_of_order = dropped_out_of_order_;
  counts.dropped_off_clock = dropped_off_clock_;
  counts.no_signal_pictures = no_signal_pictures_;
  counts.samples = samples_;
  counts.samples_off_clock = samples_off_clock_;
  return counts;
}

FrameAge LivePipeline::age() const {
  std::vector<SensorDuration> ages;
  {
    const std::lock_guard lock(mutex_);
    ages.assign(ages_.begin(), ages_.end());
  }
  if (ages.empty()) return {};
  std::ranges::sort(ages);
  return {ages[ages.size() / 2], ages[ages.size() * 99 / 100]};
}

}  // namespace gimbal
