#include "daemon/gimbalctl/stabilize_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <deque>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/frame_drawer.hpp"
#include "daemon/gimbalctl/estimation.hpp"
#include "daemon/gimbalctl/path_log.hpp"
#include "daemon/gimbalctl/stabilize_report.hpp"
#include "daemon/gimbalctl/warnings.hpp"
#include "drivers/replay/replay_camera.hpp"
#include "drivers/replay/session.hpp"
#include "drivers/replay/stamped_log.hpp"
#include "pipeline/fill/past_frames.hpp"
#include "pipeline/path/steadiness.hpp"
#include "pipeline/sink/frame_sink.hpp"
#include "pipeline/stabilizer.hpp"
#include "pipeline/warp/warper.hpp"

namespace gimbal {
namespace {

constexpr double kShakeCutoffHz = 1.0;

/// Frames a second by the stamps themselves: the median step counts, so that gaps do not.
double rate_of(const std::vector<FrameStamp>& frames) {
  const double step_s = to_seconds(median_step(frames));
  return step_s > 0 ? 1 / step_s : kThesisFps;
}

/// What the path waits for is all that a limited latency allows.
std::unique_ptr<AttitudeStream> attitudes_for(const StabilizeRequest& request) {
  if (request.latency) return make_prompt_attitudes(request.estimator);
  return make_attitudes(request.estimator, Lookahead::everything());
}

/// Three files of three names, none of which the recording is made of.
Result<void> outputs_are_apart(const StabilizeRequest& request) {
  const std::array<std::pair<std::string_view, std::filesystem::path>, 3> outputs = {
      {{"-o", request.out}, {"--path-log", request.path_log}, {"--report", request.report}}};
  constexpr std::array<std::string_view, 4> kLogs = {"session.toml", "frames.csv", "gyro.csv",
                                                     "accel.csv"};
  for (auto one = outputs.begin(); one != outputs.end(); ++one) {
    if (one->second.empty()) continue;
    const std::filesystem::path file = std::filesystem::weakly_canonical(one->second);
    for (auto other = std::next(one); other != outputs.end(); ++other) {
      if (!other->second.empty() && file == std::filesystem::weakly_canonical(other->second)) {
        return bad_input(fmt::format("{} {}: {} is to be written there, too", other->first,
                                     other->second.string(), one->first));
      }
    }
    for (const std::string_view log : kLogs) {
      if (file != std::filesystem::weakly_canonical(request.session / log)) continue;
      return bad_input(fmt::format("{} {}: is a part of the recording; give another name",
                                   one->first, one->second.string()));
    }
  }
  return {};
}

/// One run: from the open session to the finished output.
class Job {
 public:
  Job(const StabilizeRequest& request, const Session& session)
      : request_(request), session_(session), fps_(rate_of(session.frames)) {}

  [[nodiscard]] Result<void> run();

 private:
  [[nodiscard]] Result<void> plan();
  [[nodiscard]] Result<void> open_streams();
  [[nodiscard]] Result<void> make_warper(ImageSize size);
  [[nodiscard]] AudioTrack audio() const;
  [[nodiscard]] Result<void> write_all();
  [[nodiscard]] Result<std::optional<VideoFrame>> next_frame();
  [[nodiscard]] Result<void> take(const VideoFrame& frame);
  [[nodiscard]] Result<void> begin_drawing(const VideoFrame& frame);
  [[nodiscard]] Result<void> write_oldest();
  [[nodiscard]] std::size_t frames_ahead() const;
  [[nodiscard]] std::vector<Neighbour> neighbours_of(const VirtualCamera& camera) const;
  [[nodiscard]] Result<std::unique_ptr<Warper>> draw_on_the_cpu(std::unique_ptr<Warper> failed,
                                                                const Error& error);
  [[nodiscard]] Result<void> finish();
  void measure_steadiness();
  void add_to_session();
  void note(const VirtualCamera& camera, std::int64_t border_px);
  void warn(std::string warning);

  /// A frame that is being drawn.
  struct Begun {
    VirtualCamera camera;
    std::int64_t border_px;  ///< where it is not filled
  };

  const StabilizeRequest& request_;
  const Session& session_;
  double fps_;
  std::int64_t frames_with_border_ = 0;
  StabilizeReport report_;

  std::optional<Stabilizer> stabilizer_;  ///< none without a gyro: frames pass through
  std::vector<VirtualCamera> cameras_;    ///< one a frame stamp
  Eigen::Quaterniond q_log_world_ = Eigen::Quaterniond::Identity();  ///< to the path log's world
  std::unique_ptr<ReplayCamera> source_;
  std::optional<VideoFrame> first_frame_;  ///< read before the sink was opened
  std::optional<FrameDrawer> drawer_;
  std::deque<Begun> begun_;       ///< what it has in flight
  std::deque<VideoFrame> ahead_;  ///< the frame that is drawn next, and those that may fill it
  PastFrames past_;
  std::unique_ptr<FrameSink> sink_;
  std::optional<PathLog> path_log_;
};

Result<void> Job::run() {
  report_.session = request_.session.string();
  report_.output = request_.out;
  report_.amount = request_.correction == Correction::rectify_only ? 0 : request_.amount;
  report_.border = name_of(request_.border, border_names());
  report_.estimator = name_of(request_.estimator, estimator_names());
  report_.horizon = name_of(request_.lock.horizon, horizon_names());
  report_.path = name_of(request_.path, path_names());
  report_.interpolation = name_of(request_.interpolation, interpolation_names());
  report_.latency_frames = request_.latency;
  if (request_.latency) {
    report_.latency_s = static_cast<double>(*request_.latency) / fps_;
  }
  report_.warnings = session_.warnings;
  print_warnings(report_.warnings);

  return plan()
      .and_then([this] { return open_streams(); })
      .and_then([this] { return write_all(); })
      .and_then([this] { return finish(); });
}

/// The whole camera path, before the first picture is touched.
Result<void> Job::plan() {
  if (session_.gyro.empty()) {
    if (!request_.path_log.empty()) {
      return bad_input(session_.folder.string() +
                       ": no gyro samples, so no camera path to log: leave --path-log out");
    }
    report_.estimator = "none";
    report_.path = "none";
    return {};
  }
  const auto accelerometer =
      session_.accel.empty() ? Accelerometer::absent : Accelerometer::present;
  if (auto sound = check_horizon(request_, accelerometer); !sound) {
    return bad_input(session_.folder.string() + ": --" + sound.error().message);
  }
  const int lines = line_count(session_.camera->size, session_.camera->readout_direction);
  if (request_.reference_line &&
      !(*request_.reference_line >= 0 && *request_.reference_line < lines)) {
    return bad_input(fmt::format("--reference-row {}: must lie between 0 and {}",
                                 *request_.reference_line, lines - 1));
  }
  auto stabilizer = Stabilizer::create(*session_.camera, session_.imu, attitudes_for(request_),
                                       make_path(request_, fps_), stabilizer_options(request_));
  if (!stabilizer) return tl::unexpected(stabilizer.error());
  stabilizer_.emplace(std::move(*stabilizer));

  auto replayed = report_.estimate.measure([this] {
    return replay_samples(session_, [this](const ImuSample& sample) { stabilizer_->push(sample); });
  });
  if (!replayed) return replayed;
  report_.path_stage.measure([this] {
    for (const FrameStamp& stamp : session_.frames) stabilizer_->push(stamp);
    stabilizer_->finish();
    while (const auto camera = stabilizer_->next_camera()) cameras_.push_back(*camera);
  });
  if (!stabilizer_->suspicion().empty()) warn(std::string(stabilizer_->suspicion()));
  // Nothing tells then which way is up, and the first frame's camera is the world.
  if (session_.accel.empty()) {
    q_log_world_ = stabilizer_->real_pose(session_.frames.front()).q_world_camera.conjugate();
  }
  measure_steadiness();
  return {};
}

void Job::measure_steadiness() {
  std::vector<FramePose> before;
  std::vector<FramePose> after;
  for (const VirtualCamera& camera : cameras_) {
    before.push_back(stabilizer_->real_pose(camera.stamp));
    after.push_back({camera.stamp, camera.q_world_camera});
    if (stabilizer_->origin_of(camera.stamp) == AttitudeOrigin::predicted) {
      ++report_.frames_predicted;
    }
  }
  report_.rate_before_rad_s = rms_rate_above_rad_s(before, kShakeCutoffHz);
  report_.rate_after_rad_s = rms_rate_above_rad_s(after, kShakeCutoffHz);
  if (report_.frames_predicted > 0) {
    warn(fmt::format("{} of {} frames lie where no orientation was measured: it is held there",
                     report_.frames_predicted, cameras_.size()));
  }
}

Result<void> Job::open_streams() {
  if (auto apart = outputs_are_apart(request_); !apart) return apart;
  // Not emptied before there is something to put in its place.
  if (!request_.report.empty() && !std::ofstream(request_.report, std::ios::app)) {
    return bad_input(fmt::format("{}: cannot write the report (does the folder exist?)",
                                 request_.report.string()));
  }
  source_ = std::make_unique<ReplayCamera>(session_.video, session_.frames, fps_);
  if (auto started = source_->start(); !started) return started;
  const CameraFormat format = source_->format();
  if (stabilizer_ && format.size != session_.camera->size) {
    return bad_input(fmt::format("{}: frames are {}x{}, session.toml says {}x{} under [camera]",
                                 session_.video.string(), format.size.width, format.size.height,
                                 session_.camera->size.width, session_.camera->size.height));
  }
  if (stabilizer_) {
    if (auto made = make_warper(format.size); !made) return made;
  }
  auto first = report_.decode.measure([this] { return source_->read(); });
  if (!first) return tl::unexpected(first.error());
  first_frame_ = *std::move(first);
  auto sink = open_sink(request_.out, {format.size, format.fps, format.color}, audio());
  if (!sink) return tl::unexpected(sink.error());
  sink_ = std::move(*sink);
  if (request_.path_log.empty()) return {};
  auto log = PathLog::open(request_.path_log);
  if (!log) return tl::unexpected(log.error());
  path_log_.emplace(std::move(*log));
  return {};
}

Result<void> Job::make_warper(ImageSize size) {
  auto chosen = choose_warper(request_, size);
  if (!chosen) return tl::unexpected(chosen.error());
  drawer_.emplace(std::move(chosen->warper),
                  [this](std::unique_ptr<Warper> failed, const Error& error) {
                    return draw_on_the_cpu(std::move(failed), error);
                  });
  report_.warper_reason = std::move(chosen->reason);
  if (!chosen->warning.empty()) warn(std::move(chosen->warning));
  if (drawer_->warper().takes_native_pictures()) source_->ask_for(PictureForm::native);
  return {};
}

/// The recording's audio, moved so that what was heard with the first written picture comes first.
AudioTrack Job::audio() const {
  return {session_.video, -source_->media_time()};
}

Result<std::optional<VideoFrame>> Job::next_frame() {
  if (first_frame_) return std::exchange(first_frame_, std::nullopt);
  return report_.decode.measure([this] { return source_->read(); });
}

Result<void> Job::write_all() {
  ProgressBar progress("stabilize", static_cast<std::int64_t>(session_.frames.size()),
                       request_.progress);
  bool has_ended = false;
  while (true) {
    while (!has_ended && ahead_.size() <= frames_ahead()) {
      auto frame = next_frame();
      if (!frame) return tl::unexpected(frame.error());
      has_ended = !*frame;
      if (has_ended) break;
      ++report_.frames_in;
      ahead_.push_back(*std::move(*frame));
    }
    if (ahead_.empty()) break;
    if (auto taken = take(ahead_.front()); !taken) return taken;
    if (request_.border == Border::fill) past_.push(ahead_.front());
    ahead_.pop_front();
    progress.advance();
  }
  while (drawer_ && !drawer_->is_idle()) {
    if (auto written = write_oldest(); !written) return written;
  }
  return {};
}

/// A path that may not look further ahead is not filled from there either.
std::size_t Job::frames_ahead() const {
  if (!stabilizer_ || request_.border != Border::fill) return 0;
  return std::min(request_.latency.value_or(kMostFramesAhead), kMostFramesAhead);
}

/// Writes the frame, or begins to draw it and writes what there is no room for beside it.
Result<void> Job::take(const VideoFrame& frame) {
  if (!stabilizer_) {
    ++report_.frames_out;
    report_.zoom_sum += 1;
    report_.zoom_most = 1;
    report_.view_sum += 1;
    return report_.encode.measure([&] { return sink_->write(frame); });
  }
  auto done = report_.warp.measure([&] { return begin_drawing(frame); });
  while (done && !drawer_->has_room()) done = write_oldest();
  return done;
}

Result<void> Job::begin_drawing(const VideoFrame& frame) {
  const auto camera = std::lower_bound(
      cameras_.begin(), cameras_.end(), frame.stamp.index,
      [](const VirtualCamera& c, std::int64_t index) { return c.stamp.index < index; });
  if (camera == cameras_.end() || camera->stamp.index != frame.stamp.index) {
    return failed(fmt::format("frame {} has no place on the camera's path", frame.stamp.index));
  }
  WarpMesh mesh = stabilizer_->mesh_for(*camera);
  note_mesh(mesh, report_.mesh);
  const std::int64_t border_px = is_filled(request_.border) ? 0 : count_border_pixels(mesh);
  begun_.push_back({*camera, border_px});
  return drawer_->begin({frame, std::move(mesh), neighbours_of(*camera)});
}

Result<void> Job::write_oldest() {
  const auto drawn = report_.warp.measure([this] { return drawer_->finish(); });
  if (!drawn) return tl::unexpected(drawn.error());
  const Begun begun = begun_.front();
  begun_.pop_front();
  note(begun.camera, is_filled(request_.border) ? drawn->filled_border_px : begun.border_px);
  ++report_.frames_out;
  return report_.encode.measure([&] { return sink_->write(drawn->picture); });
}

std::vector<Neighbour> Job::neighbours_of(const VirtualCamera& camera) const {
  if (request_.border != Border::fill) return {};
  std::vector<VideoFrame> others(past_.frames().begin(), past_.frames().end());
  others.insert(others.end(), std::next(ahead_.begin()), ahead_.end());
  return stabilizer_->neighbours_of(camera, others);
}

Result<std::unique_ptr<Warper>> Job::draw_on_the_cpu(std::unique_ptr<Warper> failed,
                                                     const Error& error) {
  if (request_.warper || failed->name() == "cpu") return tl::unexpected(error);
  warn(error.message + "; drawing on the CPU from here on");
  report_.warper_reason = error.message;
  report_.copied.warp = failed->bytes_copied();
  source_->ask_for(PictureForm::nv12);
  return make_cpu_warper(request_);
}

void Job::note(const VirtualCamera& camera, std::int64_t border_px) {
  const double zoom = camera.intrinsics.fx / stabilizer_->unzoomed().fx;
  report_.zoom_sum += zoom;
  report_.zoom_most = std::max(report_.zoom_most, zoom);
  report_.view_sum += 1 / (zoom * zoom);
  if (camera.rectified < 1) ++report_.frames_rectified_in_part;
  report_.border_px += border_px;
  report_.border_px_most = std::max(report_.border_px_most, border_px);
  if (border_px > 0) ++frames_with_border_;
  if (!path_log_) return;
  VirtualCamera logged = camera;
  logged.q_world_camera = q_log_world_ * camera.q_world_camera;
  path_log_->write(logged, border_px);
}

Result<void> Job::finish() {
  if (auto finished = report_.encode.measure([this] { return sink_->finish(); }); !finished) {
    return finished;
  }
  for (const std::string& warning : source_->warnings()) warn(warning);
  for (const std::string& warning : sink_->warnings()) warn(warning);
  if (request_.border == Border::crop && frames_with_border_ > 0) {
    warn(fmt::format("{} of {} frames show a black border at zoom {:.3g}: try {}",
                     frames_with_border_, report_.frames_out, report_.zoom_most,
                     request_.zoom ? "--zoom auto" : "a larger fixed --zoom"));
  }
  if (path_log_) {
    if (auto finished = path_log_->finish(); !finished) return finished;
  }
  report_.frames_in += source_->frames_without_stamp();
  report_.frames_dropped = report_.frames_in - report_.frames_out;
  report_.copied.decode = source_->bytes_copied();
  if (drawer_) {
    const Warper& warper = drawer_->warper();
    report_.warper = warper.name();
    report_.renderer = warper.renderer();
    report_.transfers = warper.transfers();
    report_.copied.warp += warper.bytes_copied() + drawer_->bytes_copied();
  } else {
    report_.warper = "none";
  }
  report_.copied.encode = sink_->bytes_copied().value_or(0);
  add_to_session();
  return request_.report.empty() ? Result<void>{} : write_report(report_, request_.report);
}

/// `sessions show` lists what lies in the session's folder `stabilized`: a link to a video that was
/// written elsewhere, and the report. A recording that cannot be written to stays as it is.
void Job::add_to_session() {
  const bool is_file = request_.out != "-" && request_.out.find(" ! ") == std::string::npos;
  if (!is_file || session_.folder.empty()) return;
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path video = fs::absolute(request_.out, error);
  const fs::path listed = fs::absolute(session_.folder, error) / "stabilized" / video.filename();
  fs::create_directory(listed.parent_path(), error);
  if (!fs::equivalent(video.parent_path(), listed.parent_path(), error)) {
    if (fs::is_symlink(listed, error)) fs::remove(listed, error);
    // Relative, so that it holds where session and video are moved together.
    fs::create_symlink(fs::proximate(video, listed.parent_path(), error), listed, error);
  }
  if (!error) (void)write_report(report_, report_beside(listed));
}

void Job::warn(std::string warning) {
  print_warnings({&warning, 1});
  report_.warnings.push_back(std::move(warning));
}

}  // namespace

Result<void> stabilize_session(const StabilizeRequest& request) {
  const auto session = open_session(request.session);
  if (!session) return tl::unexpected(session.error());
  if (session->video.empty()) {
    return bad_input(request.session.string() +
                     ": no video in this session: video.mkv, video.mp4 or video.mov is expected");
  }
  if (!session->camera && !session->gyro.empty()) {
    return bad_input(
        request.session.string() +
        ": the lens is not known: give K (and readout_s) under [camera] in session.toml; "
        "a video with a .gcsv becomes a session by gimbalctl sessions import");
  }
  return Job(request, *session).run();
}

}  // namespace gimbal
