#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "daemon/configuration.hpp"
#include "daemon/live_pipeline.hpp"
#include "daemon/recorder.hpp"

namespace gimbal {

/// What a reload did.
struct ReloadReport {
  std::vector<std::string> applied;        ///< keys that are as the files say from now on
  std::vector<std::string> at_next_start;  ///< tables and keys that differ, but wait for that
};

/// The configuration's files as they are now: drop-ins come and go.
using ListFiles = std::function<Result<std::vector<std::filesystem::path>>()>;

/// What can be asked of a running daemon beside its pictures. Any thread may ask.
class Supervisor {
 public:
  /// `pipeline` and `recorder` live longer; `list_files` tells where the configuration comes from.
  Supervisor(LivePipeline& pipeline, Recorder& recorder, Configuration configuration,
             ListFiles list_files);

  /// Reads the files again, and tells the log and the service manager so. If they are not sound
  /// nothing changes: the daemon goes on as before.
  [[nodiscard]] Result<ReloadReport> reload();

  /// `toml`: keys of the table [stabilization] that may change while pictures are drawn. If one is
  /// refused nothing changes. Holds until the next reload.
  [[nodiscard]] Result<void> set(const std::string& toml);

  [[nodiscard]] StabilizationSettings settings() const;
  [[nodiscard]] const LivePipeline& pipeline() const { return pipeline_; }
  [[nodiscard]] Recorder& recorder() { return recorder_; }
  [[nodiscard]] const Recorder& recorder() const { return recorder_; }

 private:
  [[nodiscard]] Result<ReloadReport> take_over_files();

  LivePipeline& pipeline_;
  Recorder& recorder_;
  const ListFiles list_files_;
  mutable std::mutex mutex_;
  const Configuration at_start_;    ///< what all but the live settings follow
  StabilizationSettings settings_;  ///< as they are in force
};

}  // namespace gimbal
