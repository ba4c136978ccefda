#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "daemon/gimbalctl/calibration_profile.hpp"
#include "daemon/gimbalctl/calibrations.hpp"
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

struct Arguments {
  std::filesystem::path session;
  std::filesystem::path plot;     ///< empty: none
  std::filesystem::path profile;  ///< empty: none
  ExistingFile existing = ExistingFile::kept;
  double light_hz = 0;
  bool json = false;
  bool quiet = false;
};

/// Linear light of each value of luma (ITU-R BT.709's transfer, inverted).
std::array<double, 256> linear_light() {
  std::array<double, 256> light{};
  for (std::size_t value = 0; value < light.size(); ++value) {
    const double signal = static_cast<double>(value) / 255;
    light.at(value) = signal < 0.081 ? signal / 4.5 : std::pow((signal + 0.099) / 1.099, 1 / 0.45);
  }
  return light;
}

/// Mean of each row, or of each column for sensors that read columns, in the order of readout.
LineProfile profile_of(const VideoFrame& frame, ReadoutDirection direction) {
  static const std::array<double, 256> light_of = linear_light();
  LineProfile profile;
  profile.time_s = seconds_since_epoch(frame.stamp.time);
  profile.light.resize(static_cast<std::size_t>(line_count(frame.size, direction)));
  for (int y = 0; y < frame.size.height; ++y) {
    const std::uint8_t* const row = frame.planes[0].data + y * frame.planes[0].stride_bytes;
    for (int x = 0; x < frame.size.width; ++x) {
      profile.light[static_cast<std::size_t>(reads_rows(direction) ? y : x)] += light_of.at(row[x]);
    }
  }
  const bool is_backwards =
      direction == ReadoutDirection::bottom_up || direction == ReadoutDirection::right_left;
  if (is_backwards) std::reverse(profile.light.begin(), profile.light.end());
  return profile;
}

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
    profiles.push_back(profile_of(**frame, direction));
    bar.advance();
  }
  return profiles;
}

std::string to_json(const FlashingLight& found) {
  Json json{{"readout_s", nullptr}, {"readout_sigma_s", nullptr}, {"exposure_s", nullptr}};
  if (found.reason.empty()) {
    json["readout_s"] = found.readout_s;
    json["readout_sigma_s"] = found.readout_sigma_s;
    if (found.exposure_s) json["exposure_s"] = *found.exposure_s;
    json["bands"] = found.bands;
    json["coherence"] = found.coherence;
  }
  json["verdict"] = found.reason.empty() ? "ok" : "cannot-tell";
  json["reason"] = found.reason;
  return json.dump(2) + "\n";
}

std::string describe(const FlashingLight& found) {
  if (!found.reason.empty()) return "cannot tell: " + found.reason + "\n";
  std::string text = fmt::format("readout   {:9.3f} ± {:.3f} ms, {:.2f} bands a picture\n",
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

Result<void> write_profile(const Arguments& arguments, const Session& session,
                           const FlashingLight& found) {
  FittedCalibration fitted;
  fitted.readout = duration_from_seconds(found.readout_s);
  const std::string comments = fmt::format(
      "# readout_s measured {}, {:g} Hz; 95 % lie within {:.6f}.\n",
      by_whom("calibrate readout", session), arguments.light_hz, 2 * found.readout_sigma_s);
  return write_calibration_profile(own_toml(session), fitted, comments, arguments.profile,
                                   arguments.existing);
}

Result<void> run(const Arguments& arguments) {
  if (!(arguments.light_hz > 1 && arguments.light_hz < 1e5)) {
    return bad_input("--hz: the light's frequency must lie between 1 and 100000 Hz");
  }
  const auto session = open_session(arguments.session);
  if (!session) return tl::unexpected(session.error());
  print_warnings(session->warnings);
  const auto profiles =
      profiles_of(*session, arguments.quiet ? ProgressStyle::quiet : ProgressStyle::automatic);
  if (!profiles) return tl::unexpected(profiles.error());
  const FlashingLight found = measure_flashing_light(*profiles, arguments.light_hz);
  fmt::print("{}", arguments.json ? to_json(found) : describe(found));
  if (!arguments.plot.empty() && !found.spectrum.empty()) {
    if (auto written = write_svg(bands_plot(found), arguments.plot); !written) return written;
  }
  if (found.reason.empty()) {
    return arguments.profile.empty() ? Result<void>() : write_profile(arguments, *session, found);
  }
  return bad_input(arguments.session.string() + ": cannot tell: " + found.reason);
}

}  // namespace

void add_calibrate_readout(CLI::App& calibrate, CommandOutcome& outcome) {
  CLI::App* const command = calibrate.add_subcommand(
      "readout", "Readout time and exposure from the bands that a flashing light makes");
  const auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("session", arguments->session,
                   "Session folder: two seconds of a white surface, lit by a light that is on half "
                   "of the time, with a short exposure")
      ->required();
  command
      ->add_option("--hz", arguments->light_hz, "Flashes a second, no multiple of the frame rate")
      ->required();
  command->add_option("--plot", arguments->plot, "FILE.svg: how much bands of each number explain");
  CLI::Option* const write = command->add_option(
      "--write", arguments->profile,
      "FILE.toml: the recording's session.toml with the readout time that was found");
  command
      ->add_flag_callback(
          "--overwrite", [arguments] { arguments->existing = ExistingFile::replaced; },
          "Replace that file if it is there")
      ->needs(write);
  command->add_flag("--json", arguments->json, "For programs");
  command->add_flag("--quiet", arguments->quiet, "No progress bar");
  command->callback([arguments, &outcome] { outcome = run(*arguments); });
}

}  // namespace gimbal
