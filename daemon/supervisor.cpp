#include "daemon/supervisor.hpp"

#include <fmt/format.h>

#include <chrono>
#include <string>
#include <utility>

#include "daemon/journal.hpp"
#include "daemon/service_notify.hpp"
#include "daemon/stabilization_keys.hpp"
#include "drivers/clock/monotonic_now.hpp"

namespace gimbal {
namespace {

/// The keys that may change while pictures are drawn, as far as they differ.
std::vector<std::string> changed_live_keys(const StabilizationSettings& before,
                                           const StabilizationSettings& after) {
  std::vector<std::string> keys;
  if (before.amount != after.amount) keys.emplace_back("amount");
  if (before.path != after.path) keys.emplace_back("path");
  if (before.latency != after.latency) keys.emplace_back("latency_frames");
  if (before.zoom != after.zoom) keys.emplace_back("zoom");
  if (before.zoom_limits != after.zoom_limits) keys.emplace_back("zoom_limits");
  if (before.zoom_speed_per_s != after.zoom_speed_per_s) keys.emplace_back("zoom_speed_per_s");
  if (before.border != after.border) keys.emplace_back("border");
  if (before.lock.horizon != after.lock.horizon) keys.emplace_back("horizon");
  if (before.lock.most_roll_rad != after.lock.most_roll_rad) keys.emplace_back("horizon_range_deg");
  return keys;
}

std::vector<std::string> changed_other_keys(const Configuration& before,
                                            const Configuration& after) {
  std::vector<std::string> keys;
  if (before.stabilization.estimator != after.stabilization.estimator) {
    keys.emplace_back("stabilization.estimator");
  }
  if (before.stabilization.warper != after.stabilization.warper) {
    keys.emplace_back("stabilization.warper");
  }
  if (before.stabilization.dma_bufs != after.stabilization.dma_bufs) {
    keys.emplace_back("stabilization.dma_buf");
  }
  if (before.stabilization.interpolation != after.stabilization.interpolation) {
    keys.emplace_back("stabilization.interpolation");
  }
  if (before.stabilization.output_lens != after.stabilization.output_lens) {
    keys.emplace_back("stabilization.output_lens");
  }
  if (before.stabilization.output_fov_deg != after.stabilization.output_fov_deg) {
    keys.emplace_back("stabilization.output_fov_deg");
  }
  if (before.stabilization.threads != after.stabilization.threads) {
    keys.emplace_back("stabilization.threads");
  }
  if (before.source != after.source || before.camera != after.camera ||
      before.calibration != after.calibration) {
    keys.emplace_back("camera");
  }
  if (before.imu != after.imu || before.bias_memory != after.bias_memory) keys.emplace_back("imu");
  if (before.replay != after.replay) keys.emplace_back("replay");
  if (before.outputs != after.outputs) keys.emplace_back("outputs");
  if (before.sync != after.sync) keys.emplace_back("sync");
  if (before.control != after.control) keys.emplace_back("control");
  if (before.gpio != after.gpio) keys.emplace_back("gpio");
  if (before.recording != after.recording) keys.emplace_back("recording");
  return keys;
}

std::string names_or_nothing(const std::vector<std::string>& keys) {
  return keys.empty() ? "nothing" : fmt::format("{}", fmt::join(keys, ", "));
}

}  // namespace

Supervisor::Supervisor(LivePipeline& pipeline, Recorder& recorder, Configuration configuration,
                       ListFiles list_files)
    : pipeline_(pipeline),
      recorder_(recorder),
      list_files_(std::move(list_files)),
      at_start_(std::move(configuration)),
      settings_(at_start_.stabilization) {}

Result<ReloadReport> Supervisor::reload() {
  notify_service(fmt::format("RELOADING=1\nMONOTONIC_USEC={}",
                             monotonic_now().time_since_epoch() / std::chrono::microseconds(1)));
  auto report = take_over_files();
  if (report) {
    log_line(
        LogLevel::info,
        fmt::format("reloaded: {} changed; from the next start on: {}",
                    names_or_nothing(report->applied), names_or_nothing(report->at_next_start)),
        {"configuration", {}});
  } else {
    log_line(LogLevel::error, "not reloaded: " + report.error().message, {"configuration", {}});
  }
  notify_service("READY=1");
  return report;
}

Result<ReloadReport> Supervisor::take_over_files() {
  const auto read = list_files_().and_then(load_configuration);
  if (!read) return tl::unexpected(read.error());
  if (auto sound = pipeline_.check(read->stabilization); !sound)
    return tl::unexpected(sound.error());
  const std::lock_guard lock(mutex_);
  const ReloadReport report{changed_live_keys(settings_, read->stabilization),
                            changed_other_keys(at_start_, *read)};
  take_over_live(read->stabilization, settings_);
  pipeline_.apply(settings_);
  return report;
}

Result<void> Supervisor::set(const std::string& toml) {
  auto table = TomlTable::parse(toml, "set");
  if (!table) return tl::unexpected(table.error());
  const std::lock_guard lock(mutex_);
  StabilizationSettings changed = settings_;
  read_live_stabilization(*table, changed);
  if (auto sound = verdict(*table); !sound) return sound;
  if (auto sound = pipeline_.check(changed); !sound) return sound;
  settings_ = changed;
  pipeline_.apply(settings_);
  return {};
}

StabilizationSettings Supervisor::settings() const {
  const std::lock_guard lock(mutex_);
  return settings_;
}

}  // namespace gimbal
