#include <CLI/CLI.hpp>

#include "daemon/gimbalctl/calibration_program.hpp"
#include "daemon/gimbalctl/command_line.hpp"
#include "daemon/gimbalctl/commands.hpp"

int main(int argc, char** argv) {
  gimbal::become_calibration_program(argc, argv);
  CLI::App app{"Steady video from Linux cameras: works on recordings, talks to gimbald",
               "gimbalctl"};
  app.set_version_flag("--version", GIMBALD_VERSION);
  app.require_subcommand(1);
  gimbal::CommandOutcome outcome;
  gimbal::add_stabilize_command(app, outcome);
  gimbal::add_orient_command(app, outcome);
  gimbal::add_sync_command(app, outcome);
  gimbal::add_calibrate_command(app, outcome);
  gimbal::add_sessions_command(app, outcome);
  gimbal::add_simulate_command(app, outcome);
  gimbal::add_devices_command(app, outcome);
#ifdef GIMBALD_HAS_CONTROL
  gimbal::add_live_commands(app, outcome);
#endif
  return gimbal::run_command_line(app, argc, argv, outcome);
}
