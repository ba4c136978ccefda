#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "daemon/gimbalctl/stage_clock.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// The meshes of all frames.
struct MeshSummary {
  int most_vertex_columns = 0;
  int most_vertex_rows = 0;
  /// That all of them stay within; of those whose error is known.
  double error_px = 0;
  std::int64_t frames_of_unknown_error = 0;
};

/// Of all frames together, after the decoder and up to the encoder.
struct CopiedBytes {
  std::int64_t decode = 0;
  std::int64_t warp = 0;
  std::int64_t encode = 0;
};

void note_mesh(const WarpMesh& mesh, MeshSummary& summary);

/// What one run of `gimbalctl stabilize` did, for `--report`.
struct StabilizeReport {
  std::string session;
  std::string output;
  std::string estimator;
  std::string path;
  double amount = 0;
  std::string border;
  std::string horizon;
  std::int64_t frames_rectified_in_part = 0;  ///< sheared too much for any view
  std::optional<std::size_t> latency_frames;  ///< none: the whole recording
  double latency_s = 0;                       ///< what the path waits for; 0 when all is known

  std::string warper;
  std::string warper_reason;  ///< why this one
  std::string renderer;
  std::string transfers;  ///< of the last frame; see Warper::transfers
  std::string interpolation;
  MeshSummary mesh;
  CopiedBytes copied;

  std::int64_t frames_in = 0;
  std::int64_t frames_out = 0;
  std::int64_t frames_dropped = 0;
  /// Frames whose orientation was not measured (before, after or in a gap of the samples).
  std::int64_t frames_predicted = 0;
  std::int64_t border_px = 0;       ///< output pixels without a source, all frames
  std::int64_t border_px_most = 0;  ///< in the worst frame
  double zoom_sum = 0;
  double zoom_most = 0;
  double view_sum = 0;  ///< of 1/zoom²
  double rate_before_rad_s = 0;
  double rate_after_rad_s = 0;

  StageClock decode;
  StageClock estimate;
  StageClock path_stage;
  StageClock warp;
  StageClock encode;

  std::vector<std::string> warnings;
};

/// Where the report of a video in a session's folder `stabilized` stands: out.mp4.json for out.mp4,
/// so that out.mkv has one of its own.
[[nodiscard]] std::filesystem::path report_beside(const std::filesystem::path& video);

[[nodiscard]] Result<void> write_report(const StabilizeReport& report,
                                        const std::filesystem::path& file);

}  // namespace gimbal
