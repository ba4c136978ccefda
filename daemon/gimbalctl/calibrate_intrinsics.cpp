#include <fmt/core.h>
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/gimbalctl/board_search.hpp"
#include "daemon/gimbalctl/calibration_profile.hpp"
#include "daemon/gimbalctl/calibrations.hpp"
#include "daemon/gimbalctl/camera_options.hpp"
#include "daemon/gimbalctl/intrinsics_report.hpp"
#include "drivers/replay/calibration_keys.hpp"
#include "pipeline/intrinsics/intrinsics.hpp"

namespace gimbal {
namespace {

std::map<std::string, LensModel> lens_models() {
  std::map<std::string, LensModel> models;
  for (const auto& [name, model] : lens_model_names()) models.emplace(name, model);
  return models;
}

struct Arguments {
  std::vector<std::filesystem::path> sources;
  CameraOptions camera;
  double longest_s = 120;
  std::string board;
  double square_mm = 0;
  double marker_mm = 0;
  std::string dictionary = "DICT_4X4_50";
  std::string model = "brown";
  ResultFiles files;
  bool json = false;
  bool quiet = false;

  [[nodiscard]] ProgressStyle progress() const {
    return quiet ? ProgressStyle::quiet : ProgressStyle::automatic;
  }
  [[nodiscard]] std::string source_name() const {
    return sources.empty() ? camera.camera : sources.front().string();
  }
};

Result<CalibrationBoard> board_of(const Arguments& arguments) {
  auto board = parse_board(arguments.board);
  if (!board || board->kind == BoardKind::checkerboard) return board;
  if (!(arguments.square_mm > 0 && arguments.marker_mm > 0)) {
    return bad_input(
        "a charuco board needs --square MM and --marker MM, the sides of its squares and markers");
  }
  board->marker_squares = arguments.marker_mm / arguments.square_mm;
  board->dictionary = arguments.dictionary;
  return board;
}

/// What is known of the camera beside its lens.
struct Seen {
  BoardSearch search;
  std::optional<Session> session;
  std::string known_toml = {};  ///< what a profile says beside what is found
};

Result<Seen> look(const Arguments& arguments) {
  if (arguments.sources.empty() == arguments.camera.camera.empty()) {
    return bad_input("name either pictures, a video or a session, or a --camera");
  }
  const auto board = board_of(arguments);
  if (!board) return tl::unexpected(board.error());
  auto detector = BoardDetector::create(*board);
  if (!detector) return tl::unexpected(detector.error());
  if (arguments.sources.empty()) {
    auto known_toml = replaced_toml(arguments.files);
    if (!known_toml) return tl::unexpected(known_toml.error());
    auto camera = make_camera(arguments.camera);
    if (!camera) return tl::unexpected(camera.error());
    Seen seen{BoardSearch(std::move(*detector), ViewChoice::Pictures::running), std::nullopt,
              *std::move(known_toml)};
    const auto searched =
        search_camera(**camera, seen.search, arguments.longest_s, arguments.progress());
    if (!searched) return tl::unexpected(searched.error());
    return seen;
  }
  auto pictures = find_pictures(arguments.sources);
  if (!pictures) return tl::unexpected(pictures.error());
  auto known_toml = pictures->session ? Result<std::string>(own_toml(*pictures->session))
                                      : replaced_toml(arguments.files);
  if (!known_toml) return tl::unexpected(known_toml.error());
  Seen seen{BoardSearch(std::move(*detector), pictures->pictures), std::nullopt,
            *std::move(known_toml)};
  if (auto searched = search_files(*pictures, seen.search, arguments.progress()); !searched) {
    return tl::unexpected(searched.error());
  }
  seen.session = std::move(pictures->session);
  return seen;
}

std::string comments(const Arguments& arguments, const Seen& seen, const Intrinsics& found) {
  const std::string who =
      seen.session ? by_whom("calibrate intrinsics", *seen.session)
                   : by_whom("calibrate intrinsics",
                             std::filesystem::path(arguments.source_name()).filename().string());
  std::string text = fmt::format("# K and distortion fitted {}.\n# 95 % lie within:", who);
  const auto names = value_names(found.fit->lens.model);
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += fmt::format("{} {} {:.{}f}", i == 0 ? "" : ",", names[i], 2 * found.fit->sigmas[i],
                        i < 4 ? 3 : 6);
  }
  return text + fmt::format(
                    ".\n# {} pictures of a {}, {:.3f} px from where the lens has its corners, in "
                    "{:.0f} % of the picture.\n",
                    found.views.size(), arguments.board, found.fit->rms_px,
                    100 * found.coverage.share());
}

Result<void> write_profile(const Arguments& arguments, const Seen& seen, const Intrinsics& found) {
  FittedCalibration fitted;
  fitted.size = seen.search.size();
  fitted.lens = found.fit->lens;
  return write_calibration_profile(seen.known_toml, fitted, comments(arguments, seen, found),
                                   arguments.files);
}

/// Programs read the reason from standard output also where nothing could be opened.
tl::unexpected<Error> refused(const Arguments& arguments, const Error& error) {
  if (arguments.json) {
    Intrinsics nothing;
    nothing.reason = error.message;
    fmt::print("{}", to_json(nothing));
  }
  return tl::unexpected(error);
}

Result<void> run(const Arguments& arguments) {
  if (auto can_write = check_files(arguments.files); !can_write) {
    return refused(arguments, can_write.error());
  }
  const auto seen = look(arguments);
  if (!seen) return refused(arguments, seen.error());
  const BoardSearch& search = seen->search;
  Intrinsics found =
      calibrate_intrinsics(search.views(), search.size(), lens_models().at(arguments.model));
  if (search.views().empty()) {
    found.reason = fmt::format(
        "the board was found in none of {} pictures; is it a {}, all of it in the "
        "picture?",
        search.looked(), arguments.board);
  }
  fmt::print("{}", arguments.json ? to_json(found) : describe(found));
  if (!arguments.files.plot.empty() && found.fit) {
    if (auto plotted = write_corner_plot(found, search.size(), arguments.files.plot); !plotted) {
      return plotted;
    }
  }
  if (!found.reason.empty()) {
    return bad_input(arguments.source_name() + ": cannot tell: " + found.reason);
  }
  return write_profile(arguments, *seen, found);
}

void add_sources(CLI::App& command, Arguments& arguments) {
  command.add_option("pictures", arguments.sources,
                     "Pictures, a folder of them, a video or a session folder");
  CLI::Option* const camera = add_camera_options(command, arguments.camera);
  command
      .add_option("--seconds", arguments.longest_s,
                  "How long to look through the camera, if not all was shown before")
      ->check(CLI::PositiveNumber)
      ->needs(camera)
      ->capture_default_str();
}

void add_board(CLI::App& command, Arguments& arguments) {
  command
      .add_option("--board", arguments.board,
                  "checkerboard:9x6 (inner corners) or charuco:5x7 (squares)")
      ->required();
  command.add_option("--square", arguments.square_mm, "MM: a square's side, of a charuco board")
      ->check(CLI::PositiveNumber);
  command.add_option("--marker", arguments.marker_mm, "MM: a marker's side, of a charuco board")
      ->check(CLI::PositiveNumber);
  command.add_option("--dictionary", arguments.dictionary, "Of the markers, as OpenCV calls it")
      ->capture_default_str();
}

void add_results(CLI::App& command, Arguments& arguments) {
  add_plot_option(command, arguments.files,
                  "FILE.svg: where in the picture corners were seen, and how far off");
  add_profile_option(command, arguments.files,
                     "FILE.toml: the lens, for a session folder or the daemon's "
                     "camera.calibration; with all that a session folder's own, or a file that is "
                     "replaced, says beside");
  add_overwrite_flag(command, arguments.files);
  command.add_flag("--json", arguments.json, "For programs");
  command.add_flag("--quiet", arguments.quiet, "No progress");
}

}  // namespace

void add_calibrate_intrinsics(CLI::App& calibrate, CommandOutcome& outcome) {
  CLI::App* const command = calibrate.add_subcommand("intrinsics", kIntrinsicsPurpose);
  const auto arguments = std::make_shared<Arguments>();
  add_sources(*command, *arguments);
  add_board(*command, *arguments);
  command->add_option("--lens", arguments->model, "The lens's model")
      ->check(CLI::IsMember(names_of(lens_models())))
      ->capture_default_str();
  add_results(*command, *arguments);
  command->callback([arguments, &outcome] { outcome = run(*arguments); });
}

}  // namespace gimbal
