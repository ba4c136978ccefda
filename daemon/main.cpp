#include <fcntl.h>
#include <fmt/core.h>
#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <vector>

#include "daemon/bias_memory.hpp"
#include "daemon/configuration.hpp"
#include "daemon/corner_module.hpp"
#include "daemon/journal.hpp"
#include "daemon/live_pipeline.hpp"
#include "daemon/live_sources.hpp"
#include "daemon/offset_tracking.hpp"
#include "daemon/recorder.hpp"
#include "daemon/service_notify.hpp"
#include "daemon/supervisor.hpp"
#include "drivers/clock/monotonic_now.hpp"
#ifdef GIMBALD_HAS_GPIO
#include "daemon/record_controls.hpp"
#endif
#ifdef GIMBALD_HAS_CONTROL
#include "daemon/control_api.hpp"
#include "daemon/control_server.hpp"
#endif

namespace gimbal {
namespace {

constexpr int kExitFailed = 1;
constexpr int kExitBadInput = 2;
constexpr std::chrono::milliseconds kLook{100};

int report(const Error& error) {
  log_line(LogLevel::error, error.message);
  return error.kind == Error::Kind::bad_input ? kExitBadInput : kExitFailed;
}

/// Blocked before the first thread starts, so that none but `wait_for_end` ever sees them.
sigset_t block_signals() {
  std::signal(SIGPIPE, SIG_IGN);  // a reader that goes away is an error to tell of
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

WallTime wall_now() {
  return std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
}

/// A standard descriptor that is closed would be given to the next file or socket, and what is
/// meant for standard output would be written there.
void fill_standard_descriptors() {
  int descriptor = 0;
  while (descriptor >= 0 && descriptor <= STDERR_FILENO) {
    descriptor = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  }
  if (descriptor > STDERR_FILENO) ::close(descriptor);
}

/// Pools free the pictures that a hiccup made them hold; the allocator would keep them as holes in
/// its heap.
class MemoryReturn {
 public:
  void look(SensorTime now) {
    if (now < next_) return;
    ::malloc_trim(0);
    next_ = now + kEvery;
  }

 private:
  static constexpr SensorDuration kEvery = std::chrono::seconds(10);
  SensorTime next_;
};

/// Until a signal or the pipeline's own end. The watchdog is fed only while pictures come out.
void wait_for_end(LivePipeline& pipeline, Supervisor& daemon, BiasMemory& memory,
                  const sigset_t& signals) {
  const timespec look{0, std::chrono::nanoseconds(kLook).count()};
  std::uint64_t progress_seen = 0;
  MemoryReturn memory_return;
  while (!pipeline.has_ended()) {
    const int signal = sigtimedwait(&signals, nullptr, &look);
    if (signal == SIGINT || signal == SIGTERM) return;
    if (signal == SIGHUP) static_cast<void>(daemon.reload());
    memory.keep(pipeline.gyro_bias(), wall_now());
    memory_return.look(monotonic_now());
    if (pipeline.progress() == progress_seen) continue;
    progress_seen = pipeline.progress();
    const LiveCounts counts = pipeline.counts();
    notify_service(fmt::format("WATCHDOG=1\nSTATUS={} frames in, {} out", counts.frames_in,
                               counts.frames_out));
  }
}

double in_ms(SensorDuration duration) {
  return to_seconds(duration) * 1e3;
}

void log_summary(const LivePipeline& pipeline) {
  const LiveCounts counts = pipeline.counts();
  const FrameAge age = pipeline.age();
  log_line(LogLevel::info,
           fmt::format("{} frames in, {} out, {} dropped for want of orientation, {} before "
                       "drawing; {} samples; age when drawn: median {:.1f} ms, 99 % {:.1f} ms ({})",
                       counts.frames_in, counts.frames_out, counts.dropped_without_orientation,
                       counts.dropped_before_drawing, counts.samples, in_ms(age.median),
                       in_ms(age.p99), pipeline.renderer()));
  for (const auto& output : pipeline.outputs()) {
    log_line(LogLevel::info,
             fmt::format("output {}: {} frames written, {} dropped", output->name(),
                         output->written(), output->dropped()),
             {"output", output->name()});
  }
}

/// What a recording says of where it comes from.
Session recorded_by(const LiveSources& sources) {
  Session about;
  about.device = sources.device;
  about.camera = sources.camera_calibration;
  about.imu = sources.imu_calibration;
  about.imu_clock = "CLOCK_MONOTONIC";
  about.quality = fmt::format("{}x{}@{:g}", sources.format.size.width, sources.format.size.height,
                              sources.format.fps);
  about.notes = {"Recorded by gimbald. Stamps are CLOCK_MONOTONIC's."};
  return about;
}

/// Whether it is known well enough how the camera sees that its clock may be judged by it.
bool is_calibrated(const Configuration& configuration) {
  return configuration.source == SourceKind::replay || !configuration.calibration.file.empty();
}

/// Nothing if it is not wanted.
Result<std::unique_ptr<OffsetTracking>> offset_tracking_for(const Configuration& configuration,
                                                            const LiveSources& sources) {
  const SyncSettings& settings = configuration.sync;
  if (!settings.online.value_or(is_calibrated(configuration))) return nullptr;
  const auto corners = load_corner_follower();
  if (!corners && settings.online) return bad_input("sync.online: " + corners.error().message);
  if (!corners) {
    log_line(LogLevel::info, "the time offset is not tracked: " + corners.error().message,
             {"offset", {}});
    return nullptr;
  }
  return OffsetTracking::create(sources.camera_calibration, sources.imu_calibration, **corners,
                                settings.cpu_share);
}

int run(const Configuration& configuration, const ListFiles& list_files) {
  const sigset_t signals = block_signals();
  auto sources = open_sources(configuration);
  if (!sources) return report(sources.error());
  BiasMemory memory = bias_memory_for(configuration);
  sources->remembered_bias = memory.recall(wall_now());
  Recorder recorder(configuration.recording, sources->format, recorded_by(*sources));
  std::vector<SourceObserver*> observers = {&recorder};
  const auto tracking = offset_tracking_for(configuration, *sources);
  if (!tracking) return report(tracking.error());
  if (*tracking) observers.push_back(tracking->get());
  auto pipeline = LivePipeline::start(std::move(*sources), configuration.stabilization,
                                      configuration.outputs, observers);
  if (!pipeline) return report(pipeline.error());
  Supervisor daemon(**pipeline, recorder, configuration, list_files);
#ifdef GIMBALD_HAS_GPIO
  auto controls = RecordControls::start(configuration.gpio, recorder);
  if (!controls) return report(controls.error());
#endif
#ifdef GIMBALD_HAS_CONTROL
  ControlApi api(daemon);
  auto control = ControlServer::start(
      configuration.control, [&](const auto&... request) { return api.answer(request...); });
  if (!control) return report(control.error());
#endif
  if (*tracking) {
    (*tracking)->start([&](const OffsetReport& offset) {
      (*pipeline)->use(offset);
      if (offset.estimate.is_known) recorder.correct(offset.estimate.offset);
    });
  }
  notify_service("READY=1");
  wait_for_end(**pipeline, daemon, memory, signals);
  notify_service("STOPPING=1");
  memory.keep_last((*pipeline)->gyro_bias(), wall_now());
#ifdef GIMBALD_HAS_CONTROL
  control->reset();
#endif
#ifdef GIMBALD_HAS_GPIO
  controls->reset();
#endif
  if (recorder.status().is_recording) static_cast<void>(recorder.stop());
  if (*tracking) (*tracking)->stop();
  (*pipeline)->stop();
  log_summary(**pipeline);
  if (const auto failure = (*pipeline)->failure()) return report(*failure);
  const auto& outputs = (*pipeline)->outputs();
  return std::ranges::any_of(outputs, [](const auto& output) { return output->is_gone(); })
             ? kExitFailed
             : 0;
}

int main_of(int argc, char** argv) {
  CLI::App app{"Steady video from a camera with an IMU, live", "gimbald"};
  app.set_version_flag("--version", GIMBALD_VERSION);
  std::vector<std::filesystem::path> files;
  bool check_only = false;
  app.add_option("--config", files, "Configuration; a later one overrides keys of an earlier one");
  app.add_flag("--check-config", check_only, "Say whether the configuration is sound, and end");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    log_line(LogLevel::error, fmt::format("{} (see gimbald --help)", error.what()));
    return kExitBadInput;
  }
  const ListFiles list_files = [&files]() -> Result<std::vector<std::filesystem::path>> {
    return files.empty() ? usual_configuration_files() : files;
  };
  const auto configuration = list_files().and_then(load_configuration);
  if (!configuration) return report(configuration.error());
  if (!check_only) return run(*configuration, list_files);
  if (configuration->source == SourceKind::replay) return 0;
  const auto sound = check_lens(configuration->calibration);
  return sound ? 0 : report(sound.error());
}

}  // namespace
}  // namespace gimbal

int main(int argc, char** argv) {
  gimbal::fill_standard_descriptors();
  return gimbal::main_of(argc, argv);
}
