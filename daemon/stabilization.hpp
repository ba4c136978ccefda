#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "pipeline/path/camera_path.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/smoother/attitude_stream.hpp"
#include "pipeline/stabilizer.hpp"
#include "pipeline/timing/imu_aligner.hpp"
#include "pipeline/warp/warp_mesh.hpp"
#include "pipeline/warp/warper.hpp"

namespace gimbal {

enum class EstimatorKind : std::uint8_t { ekf, thesis };
enum class PathKind : std::uint8_t { hann, adaptive_hann, bounded };
enum class WarperKind : std::uint8_t { gles, cpu };
enum class Correction : std::uint8_t { rectify_and_stabilize, rectify_only };

// The words for these on command lines and in configuration files.
[[nodiscard]] const std::map<std::string, EstimatorKind>& estimator_names();
[[nodiscard]] const std::map<std::string, PathKind>& path_names();
[[nodiscard]] const std::map<std::string, WarperKind>& warper_names();
[[nodiscard]] const std::map<std::string, DmaBufUse>& dma_buf_use_names();
[[nodiscard]] const std::map<std::string, Interpolation>& interpolation_names();
[[nodiscard]] const std::map<std::string, OutputLens>& output_lens_names();
[[nodiscard]] const std::map<std::string, Border>& border_names();
[[nodiscard]] const std::map<std::string, Horizon>& horizon_names();

/// The word for a value; each has one.
template <typename Value>
[[nodiscard]] const std::string& name_of(Value value, const std::map<std::string, Value>& names) {
  return std::ranges::find_if(names, [&](const auto& named) { return named.second == value; })
      ->first;
}

constexpr double kNarrowestOutputFov_deg = 1;
constexpr double kWidestOutputFov_deg = 150;

constexpr double kWidestHorizonRange_deg = 180;

constexpr int kMostDrawingThreads = 64;

/// How much of the future an orientation may use.
struct Lookahead {
  static Lookahead nothing() { return {std::chrono::seconds(0)}; }
  static Lookahead everything() { return {std::nullopt}; }

  std::optional<SensorDuration> lag;  ///< none: the whole recording
};

/// The thesis' filter never looks ahead, whatever it is allowed, and has no parameters of `ekf`.
[[nodiscard]] std::unique_ptr<AttitudeStream> make_attitudes(EstimatorKind kind,
                                                             const Lookahead& lookahead,
                                                             const AttitudeEkfParameters& ekf = {});

/// For frames that cannot wait: at once, with the filter's corrections coming by and by.
[[nodiscard]] std::unique_ptr<AttitudeStream> make_prompt_attitudes(
    EstimatorKind kind, const AttitudeEkfParameters& ekf = {});

constexpr double kLargestZoom = 10;
constexpr double kFastestZoom_per_s = 10;

/// Between which an automatic zoom stays.
struct ZoomLimits {
  double least = 1;
  double most = 1;

  bool operator==(const ZoomLimits&) const = default;
};

/// Whether 1 <= least <= most <= 10.
[[nodiscard]] bool make_sense(const ZoomLimits& limits);

/// What a person chooses about the picture, for a recording and for a live camera alike.
struct StabilizationSettings {
  double amount = 1;                       ///< 0 (rectified only) to 1
  PathLatency latency;                     ///< frames; none for the whole recording
  std::optional<double> zoom;              ///< none: as little as is needed
  std::optional<ZoomLimits> zoom_limits;   ///< of a zoom as needed; none: the usual ones
  std::optional<double> zoom_speed_per_s;  ///< that it grows by at most; none: the usual one
  Border border = Border::crop;
  std::optional<WarperKind> warper;  ///< none: GLES on a GPU, else the CPU
  DmaBufUse dma_bufs = DmaBufUse::on_gpus;
  Interpolation interpolation = Interpolation::bilinear;
  OutputLens output_lens = OutputLens::rectilinear;
  std::optional<double> output_fov_deg;  ///< none: the focal length that the camera has
  std::optional<int> threads;            ///< that draw a frame on the CPU; none: as many as pay
  EstimatorKind estimator = EstimatorKind::ekf;
  PathKind path = PathKind::bounded;
  HorizonLock lock;
  Correction correction = Correction::rectify_and_stabilize;
  std::optional<double> reference_line;  ///< none: the middle

  bool operator==(const StabilizationSettings&) const = default;
};

/// Takes over what may change while pictures are drawn: amount, path, latency, zoom, its limits and
/// speed, border and horizon.
void take_over_live(const StabilizationSettings& from, StabilizationSettings& to);

/// Without an accelerometer nothing tells which way is up; the thesis' low-passes do not ask.
[[nodiscard]] Result<void> check_horizon(const StabilizationSettings& settings,
                                         Accelerometer accelerometer);

/// What a zoom's limits and speed do not go with: a fixed zoom, borders that are not cropped, and a
/// path whose zoom only grows. The line begins with the name of what is wrong, as the command line
/// has it: zoom-limits or zoom-speed.
[[nodiscard]] Result<void> check_zoom(const StabilizationSettings& settings);

[[nodiscard]] std::unique_ptr<CameraPath> make_path(const StabilizationSettings& settings,
                                                    double fps);

[[nodiscard]] StabilizerOptions stabilizer_options(const StabilizationSettings& settings);

struct ChosenWarper {
  std::unique_ptr<Warper> warper;
  std::string reason;   ///< why this one, for reports
  std::string warning;  ///< what is not as hoped for; may be empty
};

/// To be called on the thread that will draw. Fails where what was asked for cannot be had.
[[nodiscard]] Result<ChosenWarper> choose_warper(const StabilizationSettings& settings,
                                                 ImageSize size);

/// The one that draws where no other can.
[[nodiscard]] std::unique_ptr<Warper> make_cpu_warper(const StabilizationSettings& settings);

}  // namespace gimbal
