#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <string>

#include "daemon/gimbalctl/commands.hpp"
#include "daemon/gimbalctl/stabilize_session.hpp"

namespace gimbal {
namespace {

/// The values as they stand on the command line, before they are understood.
struct Arguments {
  StabilizeRequest request;
  std::string latency = "full";
  std::string zoom = "auto";
  std::string zoom_limits;
  std::string warper;
  std::string interpolation = "bilinear";
  std::string output_lens = "rectilinear";
  std::string border = "crop";
  std::string path = "bounded";
  std::string horizon = "off";
  double horizon_range_deg = 45;
  std::string estimator = "ekf";
};

template <typename Number>
std::optional<Number> parse_whole(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

Result<PathLatency> parse_latency(const std::string& text) {
  if (text == "full") return PathLatency{};
  const auto frames = parse_whole<unsigned>(text);
  if (!frames) return bad_input("--latency " + text + ": expected a number of frames, or full");
  return PathLatency{*frames};
}

Result<std::optional<double>> parse_zoom(const std::string& text) {
  if (text == "auto") return std::optional<double>{};
  const auto ratio = parse_whole<double>(text);
  if (!ratio || !(*ratio >= 1 && *ratio <= kLargestZoom)) {
    return bad_input("--zoom " + text + ": expected auto, or a ratio from 1 to 10, such as 1.15");
  }
  return std::optional<double>{*ratio};
}

/// LEAST..MOST, or nothing at all.
Result<std::optional<ZoomLimits>> parse_zoom_limits(const std::string& text) {
  if (text.empty()) return std::optional<ZoomLimits>{};
  const std::size_t dots = text.find("..");
  if (dots != std::string::npos) {
    const auto least = parse_whole<double>(text.substr(0, dots));
    const auto most = parse_whole<double>(text.substr(dots + 2));
    if (least && most && make_sense({*least, *most})) {
      return std::optional<ZoomLimits>({*least, *most});
    }
  }
  return bad_input("--zoom-limits " + text +
                   ": expected two ratios from 1 to 10, the lesser first, such as 1.0..1.4");
}

Result<void> run(Arguments& arguments) {
  StabilizeRequest& request = arguments.request;
  const auto latency = parse_latency(arguments.latency);
  if (!latency) return tl::unexpected(latency.error());
  if (std::isnan(request.amount)) return bad_input("--amount nan: expected a number from 0 to 1");
  const auto zoom = parse_zoom(arguments.zoom);
  if (!zoom) return tl::unexpected(zoom.error());
  request.latency = *latency;
  request.zoom = *zoom;
  const auto limits = parse_zoom_limits(arguments.zoom_limits);
  if (!limits) return tl::unexpected(limits.error());
  request.zoom_limits = *limits;
  if (!arguments.warper.empty()) request.warper = warper_names().at(arguments.warper);
  request.interpolation = interpolation_names().at(arguments.interpolation);
  request.output_lens = output_lens_names().at(arguments.output_lens);
  if (request.output_fov_deg && request.output_lens == OutputLens::kept) {
    return bad_input("--output-fov: is for --output-lens rectilinear");
  }
  request.border = border_names().at(arguments.border);
  request.path = path_names().at(arguments.path);
  request.lock.horizon = horizon_names().at(arguments.horizon);
  request.lock.most_roll_rad = arguments.horizon_range_deg * std::numbers::pi / 180;
  request.estimator = estimator_names().at(arguments.estimator);
  if (auto sound = check_zoom(request); !sound) return bad_input("--" + sound.error().message);
  return stabilize_session(request);
}

void add_options(CLI::App& command, Arguments& arguments) {
  StabilizeRequest& request = arguments.request;
  command
      .add_option("session", request.session, "Session folder, or a video with a .gcsv beside it")
      ->required();
  command
      .add_option("-o,--output", request.out,
                  "FILE.mp4, .mkv or .y4m; - for y4m on standard output; or a GStreamer pipeline, "
                  "recognised by \" ! \"")
      ->required();
  command.add_option("--amount", request.amount, "How steady, 0 (rectified only) to 1")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command.add_option("--latency", arguments.latency, "Frames of future the path may use, or full")
      ->capture_default_str();
  command.add_option("--zoom", arguments.zoom, "Fixed ratio, such as 1.15, or auto")
      ->capture_default_str();
  command
      .add_option("--zoom-limits", arguments.zoom_limits, "Between which an automatic zoom stays")
      ->option_text("LEAST..MOST [1..1.25]");
  command
      .add_option("--zoom-speed", request.zoom_speed_per_s,
                  "How fast it grows at most, of the picture's size a second")
      ->check(CLI::Range(std::numeric_limits<double>::min(), kFastestZoom_per_s))
      ->option_text("PER_S [0.08]");
  command.add_option("--border", arguments.border, "What to show past the edge of the frame")
      ->transform(CLI::IsMember(names_of(border_names())))
      ->option_text("crop|extend|mirror|black|blur|fill [crop]");
  command.add_option("--warper", arguments.warper, "What draws [gles if there is a GPU, else cpu]")
      ->check(CLI::IsMember(names_of(warper_names())))
      ->option_text("gles|cpu");
  command.add_option("--threads", request.threads, "That draw a frame on the CPU")
      ->check(CLI::Range(1, kMostDrawingThreads))
      ->option_text("N");
  command
      .add_option("--interpolation", arguments.interpolation,
                  "How the picture is read between its pixels")
      ->transform(CLI::IsMember(names_of(interpolation_names())))
      ->option_text("bilinear|bicubic [bilinear]");
  command.add_option("--output-lens", arguments.output_lens, "What the picture looks taken with")
      ->transform(CLI::IsMember(names_of(output_lens_names())))
      ->option_text("rectilinear|kept [rectilinear]");
  command
      .add_option("--output-fov", request.output_fov_deg,
                  "How many degrees a rectilinear picture is wide")
      ->check(CLI::Range(kNarrowestOutputFov_deg, kWidestOutputFov_deg))
      ->option_text("DEG");
  command.add_option("--estimator", arguments.estimator, "How orientation is estimated")
      ->transform(CLI::IsMember(names_of(estimator_names())))
      ->option_text("ekf|thesis [ekf]");
  command.add_option("--path", arguments.path, "How the camera's path is smoothed")
      ->transform(CLI::IsMember(names_of(path_names())))
      ->option_text("bounded|hann|adaptive-hann [bounded]");
  command.add_option("--horizon", arguments.horizon, "Whether the horizon is kept level")
      ->transform(CLI::IsMember(names_of(horizon_names())))
      ->option_text("off|soft|hard [off]");
  command
      .add_option("--horizon-range", arguments.horizon_range_deg,
                  "How many degrees of roll are levelled; more stays in the picture")
      ->check(CLI::Range(0.0, kWidestHorizonRange_deg))
      ->option_text("DEG [45]");
  command.add_flag_callback(
      "--rectify-only", [&request] { request.correction = Correction::rectify_only; },
      "Take out the rolling shutter, leave the motion");
  command.add_option("--reference-row", request.reference_line,
                     "Row (column, for sensors that read columns) whose instant the picture shows "
                     "[the middle one]");
  command.add_option("--path-log", request.path_log,
                     "Write the virtual camera of each frame (CSV)");
  command.add_option("--report", request.report, "Write what was done and measured (JSON)");
  command.add_flag_callback(
      "--quiet", [&request] { request.progress = ProgressStyle::quiet; }, "No progress bar");
}

}  // namespace

void add_stabilize_command(CLI::App& app, CommandOutcome& outcome) {
  CLI::App* command = app.add_subcommand("stabilize", "Write a recording rectified and steady");
  const auto arguments = std::make_shared<Arguments>();
  add_options(*command, *arguments);
  command->callback([arguments, &outcome] { outcome = run(*arguments); });
}

}  // namespace gimbal
