#include "daemon/live_pipeline.hpp"

#include <algorithm>
#include <utility>

#include "daemon/journal.hpp"
#include "drivers/replay/paced_replay.hpp"

namespace gimbal {
namespace {

/// Two seconds of a fast IMU.
constexpr std::size_t kHeldInflow = 4096;
/// What may wait for the one that draws: more would only be late.
constexpr std::size_t kHeldDrawings = 2;
/// Frames that may wait for orientations beside those that the path waits for.
constexpr std::size_t kHeldForOrientation = 15;
constexpr std::size_t kRememberedAges = 1000;

}  // namespace

Result<std::unique_ptr<LivePipeline>> LivePipeline::start(LiveSources sources,
                                                          const StabilizationSettings& settings,
                                                          const std::vector<std::string>& outputs) {
  const double fps = sources.camera_calibration.fps;
  auto stabilizer = Stabilizer::create(sources.camera_calibration, sources.imu_calibration,
                                       make_attitudes(settings.estimator, Lookahead::nothing()),
                                       make_path(settings, fps > 0 ? fps : kThesisFps),
                                       stabilizer_options(settings));
  if (!stabilizer) return tl::unexpected(stabilizer.error());
  if (auto started = sources.camera->start(); !started) return tl::unexpected(started.error());
  if (sources.camera->format().size != sources.camera_calibration.size) {
    return bad_input("the camera delivers another size of picture than its calibration is for");
  }
  sources.camera->stop();
  std::unique_ptr<LivePipeline> pipeline(
      new LivePipeline(std::move(sources), std::move(*stabilizer), settings, outputs));
  if (auto started = pipeline->start_threads(); !started) return tl::unexpected(started.error());
  return pipeline;
}

/// The sources start last, so that no frame waits for a renderer that is being opened.
Result<void> LivePipeline::start_threads() {
  std::promise<Result<void>> can_draw;
  auto drawing = can_draw.get_future();
  threads_.emplace_back([this, &can_draw] { draw(can_draw); });
  if (auto opened = drawing.get(); !opened) return opened;
  threads_.emplace_back([this] { follow(); });
  if (auto started = sources_.camera->start(); !started) return started;
  if (auto started = sources_.imu->start(); !started) return started;
  threads_.emplace_back([this] { read_imu(); });
  threads_.emplace_back([this] { read_camera(); });
  return {};
}

LivePipeline::LivePipeline(LiveSources sources, Stabilizer stabilizer,
                           const StabilizationSettings& settings,
                           const std::vector<std::string>& outputs)
    : sources_(std::move(sources)),
      settings_(settings),
      most_held_(settings.latency.value_or(0) + kHeldForOrientation),
      inflow_(kHeldInflow),
      drawings_(kHeldDrawings),
      stabilizer_(std::move(stabilizer)),
      aligner_(sources_.accelerometer) {
  for (const std::string& output : outputs) {
    outputs_.push_back(std::make_unique<Output>(output, sources_.camera->format().fps));
  }
}

LivePipeline::~LivePipeline() {
  stop();
}

void LivePipeline::stop() {
  sources_.camera->stop();
  sources_.imu->stop();
  for (std::thread& thread : threads_) {
    if (thread.joinable()) thread.join();
  }
  for (const auto& output : outputs_) output->finish();
}

void LivePipeline::read_camera() {
  while (auto frame = sources_.camera->read()) {
    if (!*frame) break;
    ++frames_in_;
    if (!inflow_.push(**std::move(frame))) break;
  }
  inflow_.push(SourceEnd{});
}

void LivePipeline::read_imu() {
  while (auto reading = sources_.imu->read()) {
    if (!*reading) break;
    ++samples_;
    const bool is_taken =
        std::visit([&](const auto& sample) { return inflow_.push(sample); }, **reading);
    if (!is_taken) break;
  }
  inflow_.push(SourceEnd{});
}

void LivePipeline::follow() {
  while (sources_running_ > 0) {
    const auto item = inflow_.pop();
    if (!item) break;
    take(*item);
    while (const auto camera = stabilizer_.next_camera()) hand_on(*camera);
  }
  aligner_.finish();
  push_aligned_samples();
  stabilizer_.finish();
  // All that the path held comes at once, and nothing comes after it: no reason to drop any.
  while (const auto camera = stabilizer_.next_camera()) {
    drawings_.wait_for_room();
    hand_on(*camera);
  }
  drawings_.close();
}

void LivePipeline::take(const Inflow& item) {
  if (const auto* frame = std::get_if<VideoFrame>(&item)) {
    take_frame(*frame);
  } else if (const auto* gyro = std::get_if<GyroSample>(&item)) {
    aligner_.push(*gyro);
    push_aligned_samples();
  } else if (const auto* accel = std::get_if<AccelSample>(&item)) {
    aligner_.push(*accel);
    push_aligned_samples();
  } else {
    --sources_running_;
  }
}

void LivePipeline::take_frame(const VideoFrame& frame) {
  if (held_.size() >= most_held_) {
    ++dropped_without_orientation_;
    return;
  }
  held_.push_back(frame);
  stabilizer_.push(frame.stamp);
}

void LivePipeline::push_aligned_samples() {
  while (const auto sample = aligner_.pop()) stabilizer_.push(*sample);
}

/// Cameras come in the order of the frames that were pushed.
void LivePipeline::hand_on(const VirtualCamera& camera) {
  drawings_.push({std::move(held_.front()), stabilizer_.mesh_for(camera)});
  held_.pop_front();
  stabilizer_.forget(camera.stamp);
}

void LivePipeline::draw(std::promise<Result<void>>& can_draw) {
  auto chosen = choose_warper(settings_.warper, sources_.camera_calibration.size);
  if (!chosen) {
    can_draw.set_value(tl::unexpected(chosen.error()));
    return;
  }
  if (!chosen->warning.empty()) log_line(LogLevel::warning, chosen->warning);
  renderer_ = chosen->warper->name() + ", " + chosen->warper->renderer();
  can_draw.set_value({});
  while (const auto drawing = drawings_.pop()) {
    const auto drawn = chosen->warper->warp(drawing->frame, drawing->mesh);
    if (!drawn) {
      fail(drawn.error());
      return;
    }
    note_age(drawn->stamp.time);
    ++frames_out_;
    for (const auto& output : outputs_) output->offer(*drawn);
  }
  has_ended_ = true;
}

void LivePipeline::note_age(SensorTime stamp) {
  const SensorDuration age = monotonic_now() - stamp;
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

LiveCounts LivePipeline::counts() const {
  LiveCounts counts;
  counts.frames_in = frames_in_;
  counts.frames_out = frames_out_;
  counts.dropped_without_orientation = dropped_without_orientation_;
  counts.dropped_before_drawing = drawings_.dropped();
  counts.samples = samples_;
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
