#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>

#include "daemon/gimbalctl/calibration_profile.hpp"
#include "daemon/gimbalctl/calibrations.hpp"
#include "daemon/gimbalctl/commands.hpp"
#include "daemon/gimbalctl/svg_plot.hpp"
#include "daemon/gimbalctl/sync_profile.hpp"
#include "daemon/gimbalctl/sync_report.hpp"
#include "daemon/gimbalctl/tracked_session.hpp"
#include "daemon/gimbalctl/warnings.hpp"
#include "drivers/replay/session.hpp"
#include "pipeline/sync/synchronization.hpp"

namespace gimbal {
namespace {

struct Arguments {
  std::filesystem::path session;
  ResultFiles files;
  bool json = false;
  bool quiet = false;
};

void print(const Arguments& arguments, const Synchronization& found,
           const CameraCalibration& camera) {
  fmt::print("{}", arguments.json ? to_json(found, camera) : describe(found, camera));
}

/// Programs read the reason from standard output also where nothing could be opened.
tl::unexpected<Error> refused(const Arguments& arguments, const Error& error) {
  if (arguments.json) {
    Synchronization nothing;
    nothing.reason = error.message;
    print(arguments, nothing, {});
  }
  return tl::unexpected(error);
}

Result<void> run(const Arguments& arguments) {
  if (auto can_write = check_files(arguments.files); !can_write) {
    return refused(arguments, can_write.error());
  }
  const auto session = open_session(arguments.session);
  if (!session) return refused(arguments, session.error());
  print_warnings(session->warnings);
  const auto data =
      track_session(*session, arguments.quiet ? ProgressStyle::quiet : ProgressStyle::automatic);
  if (!data) return refused(arguments, data.error());
  const Synchronization found = synchronize(*data, session->imu.R_camera_imu);
  print(arguments, found, data->camera);
  if (!arguments.files.plot.empty() && !found.curve.empty()) {
    if (auto written = write_svg(offset_plot(found), arguments.files.plot); !written)
      return written;
  }
  if (!found.reason.empty()) {
    return bad_input(arguments.session.string() + ": cannot tell: " + found.reason);
  }
  return write_sync_profile(*session, *found.fit, arguments.files);
}

}  // namespace

void add_sync_command(CLI::App& app, CommandOutcome& outcome) {
  CLI::App* const command = app.add_subcommand("sync", kSyncPurpose);
  const auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("session", arguments->session,
                   "Session folder with a video: a minute by hand of things that are far away")
      ->required();
  command->add_flag("--json", arguments->json, "For programs");
  add_plot_option(*command, arguments->files, "FILE.svg: how well each time offset would do");
  add_profile_option(*command, arguments->files,
                     "FILE.toml: the recording's session.toml with what was found, for a "
                     "session folder or the daemon's camera.calibration");
  add_overwrite_flag(*command, arguments->files);
  command->add_flag("--quiet", arguments->quiet, "No progress bar");
  command->callback([arguments, &outcome] { outcome = run(*arguments); });
}

}  // namespace gimbal
