#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/gimbalctl/calibration_profile.hpp"
#include "daemon/gimbalctl/calibrations.hpp"
#include "daemon/gimbalctl/camera_options.hpp"
#include "daemon/gimbalctl/flash_recording.hpp"
#include "daemon/gimbalctl/line_profiles.hpp"
#include "daemon/gimbalctl/progress_bar.hpp"
#include "daemon/gimbalctl/svg_plot.hpp"
#include "daemon/gimbalctl/warnings.hpp"
#include "drivers/replay/replay_camera.hpp"
#include "drivers/replay/session.hpp"
#include "pipeline/calibration/flashing_light.hpp"

namespace gimbal {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostFrames = 150;

constexpr double kMostJitter = 0.05;  // of a flash's period

struct Arguments {
  std::filesystem::path session;  ///< empty: through the camera
  CameraOptions camera;
  std::string line;
  ResultFiles files;
  double light_hz = 0;
  bool json = false;
  bool quiet = false;

  [[nodiscard]] ProgressStyle progress() const {
    return quiet ? ProgressStyle::quiet : ProgressStyle::automatic;
  }
  [[nodiscard]] std::string source_name() const {
    return session.empty() ? camera.camera : session.string();
  }
};

/// What was seen of the light, and what is known of it.
struct Sight {
  std::optional<Session> session;      ///< that was recorded
  std::optional<FlashRecording> live;  ///< or the light that we flashed
  std::vector<LineProfile> profiles;
  double light_hz = 0;
  std::string known_toml = {};  ///< what a profile says beside what is found
};

Result<std::vector<LineProfile>> profiles_of(const Session& session, ProgressStyle progress) {
  if (session.video.empty()) return bad_input(session.folder.string() + ": there is no video");
  const auto& known = session.camera ? session.camera : session.camera_without_lens;
  const ReadoutDirection direction = known ? known->readout_direction : ReadoutDirection::top_down;
  ReplayCamera camera(session.video, session.frames, known ? known->fps : 0);
  if (auto started = camera.start(); !started) return tl::unexpected(started.error());
  ProgressBar bar("read", static_cast<std::int64_t>(std::min(session.frames.size(), kMostFrames)),
                  progress);
  std::vector<LineProfile> profiles;
  while (profiles.size() < kMostFrames) {
    const auto frame = camera.read();
    if (!frame) return tl::unexpected(frame.error());
    if (!*frame) break;
    profiles.push_back(line_profile(**frame, direction));
    bar.advance();
  }
  return profiles;
}

Result<Sight> look_at_recording(const Arguments& arguments) {
  auto session = open_session(arguments.session);
  if (!session) return tl::unexpected(session.error());
  print_warnings(session->warnings);
  auto profiles = profiles_of(*session, arguments.progress());
  if (!profiles) return tl::unexpected(profiles.error());
  std::string known_toml = own_toml(*session);
  return Sight{std::move(*session), std::nullopt, std::move(*profiles), arguments.light_hz,
               std::move(known_toml)};
}

Result<Sight> look_through_camera(const Arguments& arguments) {
  auto known_toml = replaced_toml(arguments.files);
  if (!known_toml) return tl::unexpected(known_toml.error());
  auto recording =
      record_flashes(arguments.camera, arguments.line, arguments.light_hz, arguments.progress());
  if (!recording) return tl::unexpected(recording.error());
  Sight sight{std::nullopt, std::move(*recording), {}, 0, *std::move(known_toml)};
  sight.profiles = std::move(sight.live->profiles);
  sight.light_hz = sight.live->light_hz;
  return sight;
}

/// Why the light that we flashed is no measure; empty if it is one.
std::string unsteadiness(const FlashRecording& live) {
  const double jitter = live.jitter_s * live.light_hz;
  if (jitter <= kMostJitter) return "";
  return fmt::format(
      "the light flashed unevenly, by {:.2f} ms a change; take fewer Hz, or run it under chrt "
      "--fifo "
      "10",
      1e3 * live.jitter_s);
}

std::string to_json(const FlashingLight& found, const Sight& sight) {
  Json json{{"readout_s", nullptr}, {"readout_sigma_s", nullptr}, {"exposure_s", nullptr}};
  if (found.reason.empty()) {
    json["readout_s"] = found.readout_s;
    json["readout_sigma_s"] = found.readout_sigma_s;
    if (found.exposure_s) json["exposure_s"] = *found.exposure_s;
    json["bands"] = found.bands;
    json["coherence"] = found.coherence;
  }
  if (sight.live) {
    json["light_hz"] = sight.live->light_hz;
    json["light_jitter_s"] = sight.live->jitter_s;
    json["light_changes_skipped"] = sight.live->skipped;
  }
  json["verdict"] = found.reason.empty() ? "ok" : "cannot-tell";
  json["reason"] = found.reason;
  return json.dump(2) + "\n";
}

std::string describe(const FlashingLight& found, const Sight& sight) {
  std::string text;
  if (sight.live) {
    text += fmt::format("light     {:9.3f} Hz, ± {:.3f} ms a change, {} left out\n",
                        sight.live->light_hz, 2e3 * sight.live->jitter_s, sight.live->skipped);
  }
  if (!found.reason.empty()) return text + "cannot tell: " + found.reason + "\n";
  text += fmt::format("readout   {:9.3f} ± {:.3f} ms, {:.2f} bands a picture\n",
                      1e3 * found.readout_s, 2e3 * found.readout_sigma_s, found.bands);
  if (found.exposure_s) {
    text += fmt::format("exposure  {:9.3f} ms, if it is shorter than half of a flash's period\n",
                        1e3 * *found.exposure_s);
  }
  return text + "ok: this can be trusted\n";
}

Plot bands_plot(const FlashingLight& found) {
  Plot plot;
  plot.title = "How much of the changing brightness bands explain";
  plot.x_label = "bands in a picture";
  plot.y_label = "share";
  plot.curves.push_back({"", found.spectrum});
  if (found.bands > 0) plot.marked_x = found.bands;
  return plot;
}

Result<void> write_profile(const Arguments& arguments, const Sight& sight,
                           const FlashingLight& found) {
  FittedCalibration fitted;
  fitted.readout = duration_from_seconds(found.readout_s);
  const std::string who = sight.session ? by_whom("calibrate readout", *sight.session)
                                        : by_whom("calibrate readout", arguments.camera.camera);
  const std::string comments =
      fmt::format("# readout_s measured {}, {:g} Hz; 95 % lie within {:.6f}.\n", who,
                  sight.light_hz, 2 * found.readout_sigma_s);
  return write_calibration_profile(sight.known_toml, fitted, comments, arguments.files);
}

Result<Sight> look(const Arguments& arguments) {
  if (!(arguments.light_hz > 1 && arguments.light_hz < 1e5)) {
    return bad_input("--hz: the light's frequency must lie between 1 and 100000 Hz");
  }
  if (arguments.session.empty() == arguments.line.empty()) {
    return bad_input("name either a session, or a light's --gpio line and a --camera");
  }
  return arguments.session.empty() ? look_through_camera(arguments) : look_at_recording(arguments);
}

Result<void> run(const Arguments& arguments) {
  if (auto can_write = check_files(arguments.files); !can_write) {
    return can_write;
  }
  const auto sight = look(arguments);
  if (!sight) return tl::unexpected(sight.error());
  FlashingLight found = measure_flashing_light(sight->profiles, sight->light_hz);
  if (sight->live && found.reason.empty()) found.reason = unsteadiness(*sight->live);
  fmt::print("{}", arguments.json ? to_json(found, *sight) : describe(found, *sight));
  if (!arguments.files.plot.empty() && !found.spectrum.empty()) {
    if (auto written = write_svg(bands_plot(found), arguments.files.plot); !written) return written;
  }
  if (found.reason.empty()) {
    return write_profile(arguments, *sight, found);
  }
  return bad_input(arguments.source_name() + ": cannot tell: " + found.reason);
}

void add_light(CLI::App& command, Arguments& arguments) {
  CLI::Option* const session = command.add_option(
      "session", arguments.session,
      "Session folder: two seconds of a white surface, lit by a light that is on half of the time, "
      "with a short exposure");
  CLI::Option* const line = command.add_option(
      "--gpio", arguments.line,
      "CHIP:LINE, such as gpiochip0:17: flashes the light on this line, and looks "
      "through --camera");
  line->excludes(session)->needs(add_camera_options(command, arguments.camera)->needs(line));
  command.add_option("--hz", arguments.light_hz, "Flashes a second, no multiple of the frame rate")
      ->required();
}

}  // namespace

void add_calibrate_readout(CLI::App& calibrate, CommandOutcome& outcome) {
  CLI::App* const command = calibrate.add_subcommand(
      "readout", "Readout time and exposure from the bands that a flashing light makes");
  const auto arguments = std::make_shared<Arguments>();
  add_light(*command, *arguments);
  add_plot_option(*command, arguments->files, "FILE.svg: how much bands of each number explain");
  add_profile_option(
      *command, arguments->files,
      "FILE.toml: the recording's session.toml with the readout time that was found");
  add_overwrite_flag(*command, arguments->files);
  command->add_flag("--json", arguments->json, "For programs");
  command->add_flag("--quiet", arguments->quiet, "No progress bar");
  command->callback([arguments, &outcome] { outcome = run(*arguments); });
}

}  // namespace gimbal
