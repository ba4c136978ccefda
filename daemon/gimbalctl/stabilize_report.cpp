#include "daemon/gimbalctl/stabilize_report.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

namespace gimbal {
namespace {

using Json = nlohmann::ordered_json;

std::int64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{usage.ru_maxrss} * 1024;  // Linux counts it in KiB
}

Json to_json(const StabilizeReport& report) {
  const std::int64_t whole_frames = std::max<std::int64_t>(report.frames_out, 1);
  const auto frames = static_cast<double>(whole_frames);
  return {
      {"session", report.session},
      {"output", report.output},
      {"frames",
       {{"in", report.frames_in},
        {"out", report.frames_out},
        {"dropped", report.frames_dropped},
        {"predicted", report.frames_predicted}}},
      {"seconds",
       {{"decode", report.decode.seconds()},
        {"estimate", report.estimate.seconds()},
        {"path", report.path_stage.seconds()},
        {"warp", report.warp.seconds()},
        {"encode", report.encode.seconds()}}},
      {"warper", report.warper},
      {"warper_reason", report.warper_reason},
      {"gl_renderer", report.warper == "gles" ? Json(report.renderer) : Json(nullptr)},
      {"renderer", report.renderer},
      {"transfers", report.transfers.empty() ? Json(nullptr) : Json(report.transfers)},
      {"interpolation", report.interpolation},
      {"mesh",
       {{"max_vertex_columns", report.mesh.most_vertex_columns},
        {"max_vertex_rows", report.mesh.most_vertex_rows},
        {"error_bound_px", report.mesh.error_px},
        {"frames_of_unknown_error", report.mesh.frames_of_unknown_error}}},
      {"bytes_copied_per_frame",
       {{"decode", report.copied.decode / whole_frames},
        {"warp", report.copied.warp / whole_frames},
        {"encode", report.copied.encode / whole_frames}}},
      {"peak_memory_bytes", peak_memory_bytes()},
      {"estimator", report.estimator},
      {"path", report.path},
      {"amount", report.amount},
      {"latency_frames", report.latency_frames ? Json(*report.latency_frames) : Json("full")},
      {"latency_s", report.latency_frames ? Json(report.latency_s) : Json(nullptr)},
      {"border", report.border},
      {"horizon", report.horizon},
      {"frames_rectified_in_part", report.frames_rectified_in_part},
      {"zoom", report.zoom_sum / frames},
      {"zoom_max", report.zoom_most},
      {"retained_field_of_view", report.view_sum / frames},
      {"border_px", {{"total", report.border_px}, {"max_per_frame", report.border_px_most}}},
      {"rms_rate_above_1hz_rad_s",
       {{"before", report.rate_before_rad_s}, {"after", report.rate_after_rad_s}}},
      {"warnings", report.warnings},
  };
}

}  // namespace

void note_mesh(const WarpMesh& mesh, MeshSummary& summary) {
  summary.most_vertex_columns = std::max(summary.most_vertex_columns, mesh.vertex_columns);
  summary.most_vertex_rows = std::max(summary.most_vertex_rows, mesh.vertex_rows);
  if (mesh.error_px) {
    summary.error_px = std::max(summary.error_px, *mesh.error_px);
  } else {
    ++summary.frames_of_unknown_error;
  }
}

std::filesystem::path report_beside(const std::filesystem::path& video) {
  return video.string() + ".json";
}

Result<void> write_report(const StabilizeReport& report, const std::filesystem::path& file) {
  std::ofstream stream(file);
  // Names of files need not be UTF-8: what is not is replaced rather than refused.
  stream << to_json(report).dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  stream.close();
  if (stream) return {};
  return failed(
      fmt::format("{}: the report could not be written; is the disk full?", file.string()));
}

}  // namespace gimbal
