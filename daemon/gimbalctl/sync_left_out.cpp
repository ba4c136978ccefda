#include <memory>
#include <string>

#include "daemon/gimbalctl/commands.hpp"

namespace gimbal {

void add_sync_command(CLI::App& app, CommandOutcome& outcome) {
  CLI::App* const command =
      app.add_subcommand("sync", "Find time offset, readout and axes (not in this build)");
  const auto ignored = std::make_shared<std::string>();
  command->add_option("session", *ignored, "Session folder");
  command->allow_extras();
  command->callback([ignored, &outcome] {
    outcome = bad_input(
        "sync: built without OpenCV or Ceres; install libceres-dev, libopencv-imgproc-dev and "
        "libopencv-video-dev and build it again");
  });
}

}  // namespace gimbal
