#include "daemon/stabilization.hpp"

#include <utility>

#include "pipeline/estimator/thesis_ekf.hpp"

namespace gimbal {
namespace {

/// What an automatic zoom may use at most: the thesis' own comparison went up to 25 %.
constexpr double kAutoZoomMost = 1.25;

/// The same where the horizon has to be level: 20 degrees of roll.
constexpr double kAutoZoomMostLevel = 1.7;

/// As slowly as a horizon may come to be level without being noticed.
constexpr SensorDuration kCorrectionMemory = std::chrono::seconds(1);

ZoomChoice zoom_choice(const StabilizationSettings& settings) {
  if (settings.zoom) return {*settings.zoom, *settings.zoom};
  // Other borders fill what crop has to zoom past.
  if (settings.border != Border::crop) return {1, 1};
  const double usual_most =
      settings.lock.horizon == Horizon::hard ? kAutoZoomMostLevel : kAutoZoomMost;
  const ZoomLimits limits = settings.zoom_limits.value_or(ZoomLimits{1, usual_most});
  return {limits.least, limits.most, settings.zoom_speed_per_s.value_or(kUsualZoomSpeed_per_s)};
}

}  // namespace

const std::map<std::string, EstimatorKind>& estimator_names() {
  static const std::map<std::string, EstimatorKind> names = {{"ekf", EstimatorKind::ekf},
                                                             {"thesis", EstimatorKind::thesis}};
  return names;
}

const std::map<std::string, PathKind>& path_names() {
  static const std::map<std::string, PathKind> names = {{"hann", PathKind::hann},
                                                        {"adaptive-hann", PathKind::adaptive_hann},
                                                        {"bounded", PathKind::bounded}};
  return names;
}

const std::map<std::string, WarperKind>& warper_names() {
  static const std::map<std::string, WarperKind> names = {{"gles", WarperKind::gles},
                                                          {"cpu", WarperKind::cpu}};
  return names;
}

const std::map<std::string, DmaBufUse>& dma_buf_use_names() {
  static const std::map<std::string, DmaBufUse> names = {
      {"auto", DmaBufUse::on_gpus}, {"always", DmaBufUse::always}, {"never", DmaBufUse::never}};
  return names;
}

const std::map<std::string, Interpolation>& interpolation_names() {
  static const std::map<std::string, Interpolation> names = {{"bilinear", Interpolation::bilinear},
                                                             {"bicubic", Interpolation::bicubic}};
  return names;
}

const std::map<std::string, OutputLens>& output_lens_names() {
  static const std::map<std::string, OutputLens> names = {{"rectilinear", OutputLens::rectilinear},
                                                          {"kept", OutputLens::kept}};
  return names;
}

const std::map<std::string, Horizon>& horizon_names() {
  static const std::map<std::string, Horizon> names = {
      {"off", Horizon::off}, {"soft", Horizon::soft}, {"hard", Horizon::hard}};
  return names;
}

const std::map<std::string, Border>& border_names() {
  static const std::map<std::string, Border> names = {
      {"crop", Border::crop},   {"extend", Border::extend}, {"mirror", Border::mirror},
      {"black", Border::black}, {"blur", Border::blur},     {"fill", Border::fill}};
  return names;
}

std::unique_ptr<AttitudeStream> make_attitudes(EstimatorKind kind, const Lookahead& lookahead,
                                               const AttitudeEkfParameters& ekf) {
  if (kind == EstimatorKind::thesis) return make_causal_stream(std::make_unique<ThesisEkf>());
  if (lookahead.lag && *lookahead.lag <= SensorDuration::zero()) {
    return make_causal_stream(ekf);
  }
  FixedLagSmootherParameters parameters;
  parameters.ekf = ekf;
  parameters.lag = lookahead.lag;
  return make_smoothed_stream(parameters);
}

std::unique_ptr<AttitudeStream> make_prompt_attitudes(EstimatorKind kind,
                                                      const AttitudeEkfParameters& ekf) {
  if (kind == EstimatorKind::thesis) return make_causal_stream(std::make_unique<ThesisEkf>());
  return make_gradual_stream(ekf, kCorrectionMemory);
}

void take_over_live(const StabilizationSettings& from, StabilizationSettings& to) {
  to.amount = from.amount;
  to.path = from.path;
  to.latency = from.latency;
  to.zoom = from.zoom;
  to.zoom_limits = from.zoom_limits;
  to.zoom_speed_per_s = from.zoom_speed_per_s;
  to.border = from.border;
  to.lock = from.lock;
}

bool make_sense(const ZoomLimits& limits) {
  return limits.least >= 1 && limits.least <= limits.most && limits.most <= kLargestZoom;
}

Result<void> check_zoom(const StabilizationSettings& settings) {
  if (!settings.zoom_limits && !settings.zoom_speed_per_s) return {};
  const std::string what = settings.zoom_limits ? "zoom-limits" : "zoom-speed";
  if (settings.zoom) return bad_input(what + ": is for zoom auto");
  if (settings.border != Border::crop) {
    return bad_input(what + ": is for border crop; others have nothing to zoom past");
  }
  if (settings.zoom_speed_per_s && settings.path != PathKind::bounded) {
    return bad_input("zoom-speed: is kept by path bounded, not by " +
                     name_of(settings.path, path_names()));
  }
  return {};
}

Result<void> check_horizon(const StabilizationSettings& settings, Accelerometer accelerometer) {
  if (settings.lock.horizon == Horizon::off) return {};
  const std::string what = "horizon " + name_of(settings.lock.horizon, horizon_names());
  if (accelerometer == Accelerometer::absent) {
    return bad_input(what + ": there is no accelerometer, so nothing tells which way is up");
  }
  if (settings.correction == Correction::rectify_only) {
    return bad_input(what + ": rectifying only leaves the motion as it is");
  }
  if (settings.path != PathKind::bounded) {
    return bad_input(what + ": is kept by path bounded, not by " +
                     name_of(settings.path, path_names()));
  }
  return {};
}

std::unique_ptr<CameraPath> make_path(const StabilizationSettings& settings, double fps) {
  const ZoomChoice zoom = zoom_choice(settings);
  if (settings.correction == Correction::rectify_only) {
    return make_hann_path(1, zoom, settings.latency);
  }
  switch (settings.path) {
    case PathKind::hann:
      return make_hann_path(window_for_amount(settings.amount, fps), zoom, settings.latency);
    case PathKind::adaptive_hann:
      return make_adaptive_hann_path(adaptive_hann_for_amount(settings.amount, fps), zoom,
                                     settings.latency);
    case PathKind::bounded:
      break;
  }
  return make_bounded_path({settings.amount, settings.lock}, zoom, settings.latency);
}

StabilizerOptions stabilizer_options(const StabilizationSettings& settings) {
  StabilizerOptions options;
  options.border = settings.border;
  options.reference_line = settings.reference_line;
  options.output_lens = settings.output_lens;
  options.output_fov_deg = settings.output_fov_deg;
  return options;
}

std::unique_ptr<Warper> make_cpu_warper(const StabilizationSettings& settings) {
  return make_cpu_warper(settings.threads, settings.interpolation);
}

Result<ChosenWarper> choose_warper(const StabilizationSettings& settings, ImageSize size) {
  if (settings.warper == WarperKind::cpu) {
    return ChosenWarper{make_cpu_warper(settings), "asked for", ""};
  }
  auto gles =
      make_gles_warper(size, size, {settings.interpolation, GlesVersion::best, settings.dma_bufs});
  if (settings.warper == WarperKind::gles) {
    if (!gles) return tl::unexpected(gles.error());
    return ChosenWarper{std::move(*gles), "asked for", ""};
  }
  if (!gles) {
    return ChosenWarper{make_cpu_warper(settings), gles.error().message,
                        gles.error().message + "; drawing on the CPU"};
  }
  // GLES without a GPU is slower than drawing on the CPU straight away.
  if (is_software_renderer((*gles)->renderer())) {
    return ChosenWarper{make_cpu_warper(settings),
                        "no GPU: GLES would draw with " + (*gles)->renderer(), ""};
  }
  return ChosenWarper{std::move(*gles), "there is a GPU", ""};
}

}  // namespace gimbal
