#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "daemon/gimbalctl/estimation.hpp"
#include "daemon/gimbalctl/progress_bar.hpp"
#include "pipeline/path/camera_path.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

enum class PathKind : std::uint8_t { hann, adaptive_hann };
enum class WarperKind : std::uint8_t { gles, cpu };
enum class Correction : std::uint8_t { rectify_and_stabilize, rectify_only };

/// What the command line asks for.
struct StabilizeRequest {
  std::filesystem::path session;
  std::string out;
  double amount = 1;           ///< 0 (rectified only) to 1
  PathLatency latency;         ///< frames; none for the whole recording
  std::optional<double> zoom;  ///< none: as little as is needed
  Border border = Border::crop;
  std::optional<WarperKind> warper;  ///< none: GLES on a GPU, else the CPU
  EstimatorKind estimator = EstimatorKind::ekf;
  PathKind path = PathKind::adaptive_hann;
  Correction correction = Correction::rectify_and_stabilize;
  std::optional<double> reference_row;  ///< none: the middle
  std::filesystem::path path_log;       ///< empty: none
  std::filesystem::path report;         ///< empty: none
  ProgressStyle progress = ProgressStyle::automatic;
};

/// Reads a recording, writes it steady. Warnings go to standard error.
[[nodiscard]] Result<void> stabilize_session(const StabilizeRequest& request);

}  // namespace gimbal
